#include "pliant/sweep/folder.hpp"

#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>
#include <tuple>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/hash.hpp"
#include "pliant/core/shortened.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/files/writer.hpp"
#include "pliant/scene/read.hpp"
#include "pliant/states/engine.hpp"
#include "pliant/sweep/log.hpp"
#include "pliant/sweep/sweep_file.hpp"

namespace pliant {
namespace {

namespace fs = std::filesystem;

fs::path file_of_sweep(const fs::path& folder) { return folder / "sweep.json"; }

std::string short_text(const std::string& text) {
  constexpr std::size_t longest = 100;
  return shortened(printable(text), longest);
}

// What AtomicFile leaves if it is killed.
bool is_half_file(const fs::path& file) {
  const std::string name = file.filename().string();
  return name.starts_with('.') && name.ends_with(".part");
}

Result<std::string> absolute_path(const std::string& name) {
  if (name.empty()) return std::string();
  std::error_code error;
  const fs::path path = fs::absolute(name, error);
  if (error) return fail(ErrorCode::Unreadable, error.message(), name);
  return path.string();
}

// What the file of a sweep holds must be UTF-8.
Result<void> check_is_utf8(std::string_view what, const std::string& text) {
  if (is_utf8(text)) return {};
  return fail(
      ErrorCode::InvalidInput,
      fmt::format("{} {}: is not UTF-8, as all that a sweep keeps must be", what, printable(text)));
}

// In pieces that end between two characters.
Result<bool> is_utf8_all(std::string_view text, const StopRequest& should_stop) {
  constexpr std::size_t piece = std::size_t{1} << 20U;
  while (!text.empty()) {
    if (is_stopped(should_stop)) return interrupted();
    std::size_t end = std::min(text.size(), piece);
    for (int n = 0; n < 3 && end < text.size() && (text[end] & '\xc0') == '\x80'; ++n) ++end;
    if (!is_utf8(text.substr(0, end))) return false;
    text.remove_prefix(end);
  }
  return true;
}

Result<void> check_is_utf8(const SweepRequest& request, const StopRequest& should_stop) {
  struct Texts {
    std::string_view what;
    const std::vector<std::string>& texts;
  };
  const SweepVariation& variation = request.variation;
  for (const auto& [what, texts] : {Texts{"SCENE", request.scenes}, Texts{"--set", variation.set},
                                    Texts{"--vary", variation.vary}}) {
    for (const std::string& text : texts)
      if (auto is = check_is_utf8(what, text); !is) return is;
  }
  const auto is_text =
      is_utf8_all(variation.table ? *variation.table : std::string_view(), should_stop);
  if (!is_text) return fail(is_text.error());
  if (!*is_text)
    return fail(ErrorCode::InvalidInput,
                fmt::format("--takes {}: the table is not UTF-8; save it as UTF-8",
                            printable(variation.table_name)));
  return check_is_utf8("--root", request.root);
}

// What the scenes lead to.
Result<void> check_is_utf8(const SweepFile& file) {
  for (const SceneTexts& texts : file.texts) {
    for (const IncludedText& text : texts.included) {
      if (auto is = check_is_utf8("the included file", text.path); !is) return is;
    }
  }
  for (const InputHash& input : file.inputs)
    if (auto is = check_is_utf8("the file", input.file); !is) return is;
  return {};
}

// A folder that is removed, with those above it that were made for it, unless it is kept.
class NewFolder {
 public:
  explicit NewFolder(const fs::path& folder) {
    std::error_code error;
    for (fs::path missing = fs::absolute(folder, error); !error && !missing.empty();
         missing = missing.parent_path()) {
      if (!missing.has_filename()) continue;  // behind a slash at the end
      if (fs::exists(missing, error) || error) break;
      made_.push_back(missing);
    }
    fs::create_directories(folder, error_);
  }
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;
  ~NewFolder() {
    std::error_code ignored;  // another process may use it by now
    for (const fs::path& folder : made_)
      if (!fs::remove(folder, ignored)) return;
  }

  const std::error_code& error() const { return error_; }
  void keep() { made_.clear(); }

 private:
  std::vector<fs::path> made_;  // the innermost first
  std::error_code error_;
};

// The error with the name of a file as it was typed.
Error named(Error error, const std::string& path, const std::string& typed) {
  if (error.file == path) error.file = typed;
  for (Error& other : error.others) other = named(std::move(other), path, typed);
  return error;
}

// What is asked, with the scenes as they are now, before any value is checked.
struct Asked {
  SweepFile file;
  std::vector<Scene> scenes;
};

Result<Asked> read_request(const SweepRequest& request, const StopRequest& should_stop) {
  if (auto is = check_is_utf8(request, should_stop); !is) return fail(is.error());
  Asked asked;
  SweepFile& file = asked.file;
  file.version = PLIANT_VERSION;
  file.engine = engine_name();
  file.request = request;
  if (request.variation.table) file.table_hash = to_text(hash_of(*request.variation.table));
  auto root = absolute_path(request.root);
  if (!root) return fail(root.error());
  file.request.root = *std::move(root);
  if (auto is = check_is_utf8("the folder of --root", file.request.root); !is)
    return fail(is.error());
  for (const std::string& scene : request.scenes) {
    if (is_stopped(should_stop)) return interrupted();
    const auto path = absolute_path(scene);
    if (!path) return fail(path.error());
    if (auto is = check_is_utf8("the folder of SCENE", *path); !is) return fail(is.error());
    auto loaded = load_scene(*path, file.request.root, should_stop);
    if (!loaded) return fail(named(loaded.error(), *path, scene));
    file.texts.push_back(texts_of(*loaded));
    asked.scenes.push_back(*std::move(loaded));
  }
  return asked;
}

SweepSettings settings_of(const SweepRequest& request) {
  return {.frames = request.frames, .solver = request.solver, .root = request.root};
}

Result<Sweep> checked_sweep(Asked& asked, const StopRequest& should_stop) {
  SweepVariation variation = asked.file.request.variation;
  variation.scene_count = asked.scenes.size();
  auto takes = Takes::make(variation, should_stop);
  if (!takes) return fail(takes.error());
  return Sweep::make(std::move(asked.scenes), *std::move(takes), settings_of(asked.file.request),
                     should_stop);
}

// Whether there is no sweep and may be one. Errors: InvalidInput.
Result<bool> may_be_made(const std::string& folder) {
  std::error_code error;
  const auto is_made = [&] {
    std::error_code ignored;
    return fs::exists(file_of_sweep(folder), ignored);
  };
  if (is_made()) return false;
  const fs::file_status status = fs::status(folder, error);
  if (!fs::exists(status)) return true;
  if (!fs::is_directory(status))
    return fail(ErrorCode::InvalidInput, fmt::format("-o {}: is not a folder", printable(folder)));
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (is_half_file(entry->path())) continue;
    if (is_made()) return false;  // by another process, just now
    return fail(
        ErrorCode::InvalidInput,
        fmt::format("-o {}: is not empty, and no sweep; choose another folder", printable(folder)));
  }
  if (error) return fail(ErrorCode::Unreadable, error.message(), folder);
  return true;
}

// Gathers the lines of a log.
class Gathering {
 public:
  explicit Gathering(std::size_t count) : lines_(count) { status_.takes.resize(count); }

  void add(LogLine line) {
    if (line.take >= status_.takes.size()) return;
    TakeRecord& record = status_.takes[line.take];
    Origin& origin = lines_[line.take];
    if (!line.is_done) {
      // Of several failures the last one counts.
      const bool is_later = std::tie(line.time, line.error) > std::tie(origin.time, record.error);
      if (record.status == TakeStatus::Done || !is_later) return;
      record = {
          TakeStatus::Failed, {}, std::move(line.error), std::move(line.full_error), line.seconds};
      origin.time = std::move(line.time);
      return;
    }
    const int host = number_of(line.host);
    if (record.status != TakeStatus::Done) {
      record = {TakeStatus::Done, line.measures, {}, {}, line.seconds};
      origin = {host, {}};
    } else if (record.measures.hash != line.measures.hash) {
      // The same one stays, in whatever order they come.
      if (!origin.has_conflict) {
        const std::string &own = hosts_[origin.host], &other = hosts_[host];
        status_.conflicts.push_back({line.take, std::min(own, other), std::max(own, other)});
        origin.has_conflict = true;
      }
      if (to_text(line.measures.hash) < to_text(record.measures.hash)) {
        record.measures = line.measures;
        origin.host = host;
      }
    }
  }

  SweepStatus finish() {
    std::ranges::sort(status_.conflicts, {}, &HashConflict::take);
    return std::move(status_);
  }

 private:
  struct Origin {
    int host = 0;
    std::string time = {};  // of a failure
    bool has_conflict = false;
  };

  int number_of(const std::string& host) {
    const auto [found, is_new] = numbers_.try_emplace(host, static_cast<int>(hosts_.size()));
    if (is_new) hosts_.push_back(host);
    return found->second;
  }

  SweepStatus status_;
  std::vector<Origin> lines_;
  std::unordered_map<std::string, int> numbers_;
  std::vector<std::string> hosts_;
};

void count_takes(SweepStatus& status) {
  status.done = status.failed = 0;
  for (const TakeRecord& record : status.takes) {
    status.done += record.status == TakeStatus::Done ? 1 : 0;
    status.failed += record.status == TakeStatus::Failed ? 1 : 0;
  }
}

}  // namespace

class SweepFolder::Contents {
 public:
  Contents(std::string name, SweepRequest asked, Sweep made, std::vector<InputHash> hashes)
      : folder(std::move(name)),
        request(std::move(asked)),
        sweep(std::move(made)),
        inputs(std::move(hashes)) {
    request.variation.table.reset();
  }

  fs::path folder_of_takes() const { return fs::path(folder) / "takes"; }

  // The animation of a take.
  std::string file_of(std::size_t take) const {
    return (folder_of_takes() / fmt::format("{:05}{}", take, request.write)).string();
  }

  // Whether all files of a take are among those of the folder.
  bool has_files(std::size_t take, const std::set<std::string>& names) const {
    const auto scene = sweep.scene_of(take);
    if (!scene) return false;
    const auto frames = sweep.frames_of(*scene);
    if (!frames) return false;
    AnimationPlan plan{
        .file = file_of(take), .first_frame = frames->first, .last_frame = frames->last};
    for (const Surface& surface : scene->surfaces)
      plan.surfaces.push_back({.name = surface.name, .rest = {}});
    const auto name_of = [](const std::string& file) { return fs::path(file).filename().string(); };
    const bool has_known = std::ranges::all_of(
        files_of(plan), [&](const std::string& file) { return names.contains(name_of(file)); });
    if (!has_known || request.write != ".gltf") return has_known;
    // The name of its numbers depends on them.
    const std::string head = fs::path(plan.file).stem().string() + ".";
    for (auto name = names.lower_bound(head); name != names.end() && name->starts_with(head);
         ++name)
      if (is_named_at_the_end(plan, *name)) return true;
    return false;
  }

  std::string folder;
  SweepRequest request;
  Sweep sweep;
  mutable InputHashes inputs;
};

SweepFolder::SweepFolder(std::unique_ptr<Contents> contents) : contents_(std::move(contents)) {}
SweepFolder::SweepFolder(SweepFolder&&) noexcept = default;
SweepFolder::~SweepFolder() = default;

Result<Sweep> SweepFolder::plan(const SweepRequest& request, const StopRequest& should_stop) {
  auto asked = read_request(request, should_stop);
  if (!asked) return fail(asked.error());
  return checked_sweep(*asked, should_stop);
}

Result<SweepFolder> SweepFolder::make(const std::string& folder, const SweepRequest& request,
                                      const StopRequest& should_stop) {
  const auto is_new = may_be_made(folder);
  if (!is_new) return fail(is_new.error());
  auto asked = read_request(request, should_stop);
  if (!asked) return fail(asked.error());
  const auto open_the_same = [&]() -> Result<SweepFolder> {
    const auto there = read_sweep_file(file_of_sweep(folder), should_stop);
    if (!there) return fail(there.error());
    const std::string difference = difference_of(*there, asked->file);
    if (difference.empty()) return open(folder, should_stop);
    return fail(ErrorCode::InvalidInput,
                fmt::format("-o {}: is another sweep; it has {}", printable(folder), difference));
  };
  if (!*is_new) return open_the_same();
  auto sweep = checked_sweep(*asked, should_stop);
  if (!sweep) return fail(sweep.error());
  InputHashes inputs;
  const auto add_inputs = [&](const Scene& scene) { return inputs.add(scene, should_stop); };
  if (auto added = sweep->for_each_variant(add_inputs, should_stop); !added)
    return fail(added.error());
  asked->file.inputs = inputs.all();
  if (auto is = check_is_utf8(asked->file); !is) return fail(is.error());
  NewFolder made(folder);
  if (made.error())
    return fail(ErrorCode::Unwritable, "cannot make the folder: " + made.error().message(), folder);
  const auto written =
      write_sweep_file(asked->file, sweep->takes().plan(), file_of_sweep(folder), should_stop);
  if (!written) return fail(written.error());
  made.keep();
  if (!*written) return open_the_same();  // another process was quicker
  return SweepFolder(std::make_unique<Contents>(folder, std::move(asked->file.request),
                                                *std::move(sweep), std::move(asked->file.inputs)));
}

Result<SweepFolder> SweepFolder::open(const std::string& folder, const StopRequest& should_stop,
                                      const std::string& root) {
  auto file = read_sweep_file(file_of_sweep(folder), should_stop);
  if (!file) return fail(file.error());
  if (!root.empty()) {
    auto path = absolute_path(root);
    if (!path) return fail(path.error());
    file->request.root = *std::move(path);
  }
  if (file->engine != engine_name())
    return fail(ErrorCode::InvalidInput,
                fmt::format("{}: the sweep has engine {} of pliant {}, not {} of pliant {}, so "
                            "that takes would have other bits",
                            printable(folder), short_text(file->engine), short_text(file->version),
                            engine_name(), PLIANT_VERSION));
  std::vector<Scene> scenes;
  for (const SceneTexts& texts : file->texts) {
    if (is_stopped(should_stop)) return interrupted();
    auto scene = parse_scene(texts, file->request.root, should_stop);
    if (!scene) return fail(scene.error());
    scenes.push_back(*std::move(scene));
  }
  auto takes = Takes::of(std::move(file->takes));
  if (!takes)
    return fail(takes.error().code, takes.error().message, file_of_sweep(folder).string());
  if (!is_available(file->request.solver))
    return fail(ErrorCode::InvalidInput,
                fmt::format("{}: this build lacks the solver {}", printable(folder),
                            name_of(file->request.solver)));
  Sweep sweep = Sweep::unchecked(std::move(scenes), *std::move(takes), settings_of(file->request));
  return SweepFolder(std::make_unique<Contents>(folder, std::move(file->request), std::move(sweep),
                                                std::move(file->inputs)));
}

const std::string& SweepFolder::folder() const { return contents_->folder; }
const Sweep& SweepFolder::sweep() const { return contents_->sweep; }
const SweepRequest& SweepFolder::request() const { return contents_->request; }

Result<SweepStatus> SweepFolder::status(const StopRequest& should_stop) const {
  Gathering gathering(sweep().takes().count());
  auto read = LogReader(fs::path(folder()) / "log")
                  .read([&](LogLine line) { gathering.add(std::move(line)); }, should_stop);
  if (!read) return fail(read.error());
  SweepStatus status = gathering.finish();
  if (!request().write.empty()) {
    std::set<std::string> names;
    std::error_code ignored;
    for (fs::directory_iterator entry(contents_->folder_of_takes(), ignored), end;
         !ignored && entry != end; entry.increment(ignored)) {
      names.insert(entry->path().filename().string());
      if (is_stopped(should_stop, names.size())) return interrupted();
    }
    for (std::size_t take = 0; take < status.takes.size(); ++take) {
      if (is_stopped(should_stop)) return interrupted();
      TakeRecord& record = status.takes[take];
      if (record.status == TakeStatus::Done && !contents_->has_files(take, names)) record = {};
    }
  }
  count_takes(status);
  return status;
}

Result<void> SweepFolder::run(const FolderRun& options) const {
  const auto now = status(options.should_stop);
  if (!now) return fail(now.error());
  std::vector<std::size_t> takes;
  for (std::size_t take = 0; take < now->takes.size(); ++take) {
    if (now->takes[take].is_due(options.retry) && options.part.has(take)) takes.push_back(take);
  }
  if (options.begin) options.begin(takes.size());
  if (takes.empty()) return {};
  if (!request().write.empty()) {
    if (auto made = make_own_folder(contents_->folder_of_takes()); !made) return made;
  }
  auto log = LogFile::create(fs::path(folder()) / "log");
  if (!log) return fail(log.error());
  SweepRun run{
      .threads = options.threads,
      .max_memory = options.max_memory,
      .should_stop = options.should_stop,
      .check = [&](const Scene& scene) { return check_inputs(scene, options.should_stop); },
      .take_done = [&](const TakeOutcome& outcome) -> Result<void> {
        // A full disk is no fault of the take.
        if (!outcome.measures && outcome.measures.error().code == ErrorCode::Unwritable)
          return fail(outcome.measures.error());
        if (auto added = log->append(to_line(outcome)); !added) return added;
        if (options.take_done) options.take_done(outcome);
        return {};
      }};
  if (!request().write.empty())
    run.file_of = [this](std::size_t take) { return contents_->file_of(take); };
  return sweep().run(takes, run);
}

Result<void> SweepFolder::check_inputs(const Scene& scene, const StopRequest& should_stop) const {
  return contents_->inputs.check(scene, should_stop);
}

Result<void> SweepFolder::make_inner_folder(const std::string& name) const {
  return make_own_folder(fs::path(folder()) / name);
}

Result<void> SweepFolder::write_table(const SweepStatus& status,
                                      const StopRequest& should_stop) const {
  auto file = AtomicFile::create(fs::path(folder()) / "takes.csv");
  if (!file) return fail(file.error());
  const auto write = [&](std::string_view text) -> Result<void> {
    if (is_stopped(should_stop)) return interrupted();
    return file->write(text);
  };
  auto written = pliant::write_table(sweep(), request().scenes, status.takes, write);
  if (!written) return written;
  return file->commit();
}

}  // namespace pliant
