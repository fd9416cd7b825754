#include "pliant/sweep/sweep_file.hpp"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <functional>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "pliant/core/read_file.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/core/text.hpp"
#include "pliant/output/atomic_file.hpp"
#include "pliant/output/writer.hpp"

namespace pliant {
namespace {

using FileJson = nlohmann::ordered_json;

constexpr int format_version = 1;

std::string_view word_of(SceneChange::Kind kind) {
  return kind == SceneChange::Kind::Times ? "*" : kind == SceneChange::Kind::Plus ? "+" : "=";
}

// Writes pieces of JSON, gathered.
class JsonFile {
 public:
  JsonFile(AtomicFile& file, const StopRequest& should_stop)
      : file_(file), should_stop_(should_stop) {}

  void text(std::string_view text) {
    gathered_ += text;
    if (gathered_.size() > most_gathered) flush();
  }
  bool has_failed() const { return !written_; }
  // Throws if it is no UTF-8, as nlohmann-json does.
  void value(const FileJson& json) { text(json.dump()); }
  void quoted(std::string_view text) {
    const bool is_plain = std::ranges::all_of(
        text, [](char c) { return c >= ' ' && c < 0x7f && c != '"' && c != '\\'; });
    if (!is_plain) return value(text);
    gathered_ += '"';
    gathered_ += text;
    this->text("\"");
  }

  Result<void> finish() {
    flush();
    return std::move(written_);
  }

 private:
  static constexpr std::size_t most_gathered = std::size_t{1} << 20U;

  void flush() {
    if (written_ && is_stopped(should_stop_)) written_ = interrupted();
    size_ += gathered_.size();
    if (written_ && size_ > largest_sweep_file)
      written_ = fail(ErrorCode::InvalidInput,
                      fmt::format("the values and scenes of the sweep need more than the {} MiB "
                                  "that a sweep may have; make several",
                                  largest_sweep_file >> 20U));
    if (written_) written_ = file_.write(gathered_);
    gathered_.clear();
  }

  AtomicFile& file_;
  const StopRequest& should_stop_;
  std::size_t size_ = 0;
  std::string gathered_;
  Result<void> written_;
};

FileJson arguments_of(const SweepFile& content) {
  const SweepRequest& request = content.request;
  FileJson arguments;
  arguments["scenes"] = request.scenes;
  arguments["set"] = request.variation.set;
  arguments["vary"] = request.variation.vary;
  arguments["sample"] =
      request.variation.samples ? FileJson(*request.variation.samples) : FileJson();
  arguments["takes"] = content.table_hash;
  arguments["frames"] =
      request.frames ? FileJson{request.frames->first, request.frames->last} : FileJson();
  arguments["solver"] = name_of(request.solver);
  arguments["root"] = request.root;
  arguments["write"] = request.write;
  return arguments;
}

FileJson texts_of_scenes(const SweepFile& content) {
  FileJson all = FileJson::array();
  for (const SceneTexts& texts : content.texts) {
    FileJson one{{"file", texts.file}, {"text", texts.text}, {"included", FileJson::array()}};
    for (const IncludedText& text : texts.included)
      one["included"].push_back(
          {{"path", text.path}, {"identity", text.identity}, {"text", text.text}});
    all.push_back(std::move(one));
  }
  return all;
}

void write_content(const SweepFile& content, JsonFile& out) {
  out.text(fmt::format("{{\"sweep\": {},\n\"version\": ", format_version));
  out.value(content.version);
  out.text(",\n\"engine\": ");
  out.value(content.engine);
  out.text(",\n\"arguments\": ");
  out.value(arguments_of(content));
  out.text(",\n\"scenes\": ");
  out.value(texts_of_scenes(content));
  out.text(",\n\"files\": ");
  FileJson files = FileJson::array();
  for (const InputHash& input : content.inputs)
    files.push_back({{"file", input.file}, {"hash", to_text(input.hash)}});
  out.value(files);
  out.text(",\n\"paths\": ");
  FileJson paths = FileJson::array();
  for (const VariedPath& path : content.takes.paths)
    paths.push_back({{"path", path.path}, {"kind", word_of(path.kind)}});
  out.value(paths);
  out.text(",\n\"axes\": [");
  for (std::size_t k = 0; k < content.takes.axes.size(); ++k) {
    const TakeAxis& axis = content.takes.axes[k];
    out.text(k == 0 ? "\n{\"paths\": " : ",\n{\"paths\": ");
    out.value(axis.paths);
    out.text(fmt::format(", \"count\": {}, \"texts\": [", axis.count));
    for (std::size_t n = 0; n < axis.texts.size() && !out.has_failed(); ++n) {
      if (n > 0) out.text(",");
      out.quoted(axis.texts[n]);
    }
    out.text("]}");
  }
  out.text("]}\n");
}

// Asks whether to stop.
class Stops {
 public:
  explicit Stops(const StopRequest& should_stop) : should_stop_(should_stop) {}

  bool ask() { return is_stopped_ = is_stopped_ || pliant::is_stopped(should_stop_); }
  bool is_stopped() const { return is_stopped_; }

 private:
  const StopRequest& should_stop_;
  bool is_stopped_ = false;
};

// The characters of a text, which ends early if that is asked for.
class StoppingText {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  StoppingText(const char* at, const char* end, Stops& stops)
      : at_(at), end_(end), stops_(&stops) {}

  const char& operator*() const { return *at_; }
  StoppingText& operator++() {
    constexpr std::ptrdiff_t bytes_between_stops = std::ptrdiff_t{1} << 18U;
    ++at_;
    if ((end_ - at_) % bytes_between_stops == 0 && stops_->ask()) at_ = end_;
    return *this;
  }
  StoppingText operator++(int) {
    StoppingText before = *this;
    ++*this;
    return before;
  }
  bool operator==(const StoppingText& other) const { return at_ == other.at_; }

 private:
  const char* at_;
  const char* end_;
  Stops* stops_;
};

// Takes the texts of the axes, nearly all that a large sweep has, out of the JSON while it is
// parsed, and refuses more than a sweep can have before it takes memory.
class AxisTexts {
 public:
  using Event = FileJson::parse_event_t;

  // For nlohmann-json: whether it keeps what it has parsed. Throws if it is too much.
  bool operator()(int depth, Event event, FileJson& parsed) {
    if (event == Event::object_start || event == Event::array_start) {
      if (depth >= most_depth) throw std::invalid_argument("it is nested too deeply");
      if (depth >= 4 && is_in_axes()) throw std::invalid_argument("a value of an axis is none");
      if (event == Event::object_start && depth == 2 && is_in_axes()) texts_.emplace_back();
      return count();
    }
    if (event == Event::key) {
      if (depth == 1) section_ = parsed.get_ref<const std::string&>();
      if (depth == 3) member_ = parsed.get_ref<const std::string&>();
      return count();
    }
    if (event != Event::value) return true;
    if (depth != 4 || !is_in_axes() || member_ != "texts" || texts_.empty()) return count();
    if (++text_count_ > most_take_texts) throw std::invalid_argument("it has too many values");
    texts_.back().push_back(parsed.get_ref<const std::string&>());
    return false;
  }

  std::vector<TextList> take() { return std::move(texts_); }

 private:
  static constexpr int most_depth = 6;
  // Several for each take: a sweep may have a million scenes, and as many meshes.
  static constexpr std::size_t most_counted = 20'000'000;

  bool is_in_axes() const { return section_ == "axes"; }
  bool count() {
    if (++count_ > most_counted) throw std::invalid_argument("it has too many members");
    return true;
  }

  std::string section_, member_;
  std::size_t count_ = 0;
  std::size_t text_count_ = 0;
  std::vector<TextList> texts_;
};

// Reads members that must be there; throws if they are not, as nlohmann-json does.

std::vector<std::string> strings_of(FileJson& json) {
  std::vector<std::string> strings;
  strings.reserve(json.size());
  for (FileJson& one : json) strings.push_back(std::move(one.get_ref<std::string&>()));
  return strings;
}

int frame_of(const FileJson& json) {
  const auto frame = json.is_number_integer() ? json.get<std::int64_t>() : std::int64_t{1} << 40;
  if (frame < std::numeric_limits<int>::min() || frame > std::numeric_limits<int>::max())
    throw std::invalid_argument("a frame is none");
  return static_cast<int>(frame);
}

SweepRequest request_of(FileJson& arguments) {
  SweepRequest request;
  request.scenes = strings_of(arguments.at("scenes"));
  request.variation.scene_count = request.scenes.size();
  request.variation.set = strings_of(arguments.at("set"));
  request.variation.vary = strings_of(arguments.at("vary"));
  if (const FileJson& samples = arguments.at("sample"); !samples.is_null())
    request.variation.samples = samples.get<std::size_t>();
  if (const FileJson& frames = arguments.at("frames"); !frames.is_null())
    request.frames = TakeFrames{frame_of(frames.at(0)), frame_of(frames.at(1))};
  const auto solver = solver_choice(arguments.at("solver").get_ref<const std::string&>());
  if (!solver) throw std::invalid_argument("the solver is unknown");
  request.solver = *solver;
  request.root = arguments.at("root").get<std::string>();
  request.write = arguments.at("write").get<std::string>();
  // It becomes a part of file names.
  const std::string written = "takes" + request.write;
  if (!request.write.empty() && (!check_ending(written) || ending_of(written) != request.write))
    throw std::invalid_argument("the ending of --write is none");
  return request;
}

std::vector<SceneTexts> texts_of(FileJson& scenes) {
  std::vector<SceneTexts> all;
  for (FileJson& scene : scenes) {
    SceneTexts texts{scene.at("file").get<std::string>(), scene.at("text").get<std::string>()};
    for (const FileJson& one : scene.at("included"))
      texts.included.push_back({one.at("path").get<std::string>(),
                                one.at("identity").get<std::string>(),
                                one.at("text").get<std::string>()});
    all.push_back(std::move(texts));
  }
  return all;
}

TakeParts takes_of(const FileJson& json, std::vector<TextList> texts, const SweepRequest& request) {
  TakeParts parts{.scene_count = request.scenes.size()};
  for (const std::string& typed : request.variation.set) {
    auto change = parse_change(typed);
    if (!change) throw std::invalid_argument(change.error().message);
    parts.set.push_back(*std::move(change));
  }
  for (const FileJson& one : json.at("paths")) {
    const auto& kind = one.at("kind").get_ref<const std::string&>();
    parts.paths.push_back({one.at("path").get<std::string>(), kind == "*" ? SceneChange::Kind::Times
                                                              : kind == "+"
                                                                  ? SceneChange::Kind::Plus
                                                                  : SceneChange::Kind::Set});
  }
  const FileJson& axes = json.at("axes");
  if (axes.size() != texts.size()) throw std::invalid_argument("the axes are not complete");
  for (std::size_t k = 0; k < texts.size(); ++k)
    parts.axes.push_back({axes[k].at("paths").get<std::vector<std::size_t>>(), std::move(texts[k]),
                          axes[k].at("count").get<std::size_t>()});
  return parts;
}

SweepFile content_of(FileJson json, std::vector<TextList> texts) {
  SweepFile content;
  if (json.at("sweep").get<int>() != format_version)
    throw std::invalid_argument("another version of the format");
  content.version = json.at("version").get<std::string>();
  content.engine = json.at("engine").get<std::string>();
  content.request = request_of(json.at("arguments"));
  content.table_hash = json.at("arguments").at("takes").get<std::string>();
  content.texts = texts_of(json.at("scenes"));
  if (content.texts.size() != content.request.scenes.size())
    throw std::invalid_argument("the scenes are not complete");
  for (const FileJson& one : json.at("files")) {
    const auto hash = to_hash(one.at("hash").get_ref<const std::string&>());
    if (!hash) throw std::invalid_argument("a hash is none");
    content.inputs.push_back({one.at("file").get<std::string>(), *hash});
  }
  content.takes = takes_of(json, std::move(texts), content.request);
  return content;
}

// `--vary a=1 --vary b=2`, or `no --vary`.
std::string options_text(std::string_view option, const std::vector<std::string>& values) {
  if (values.empty()) return fmt::format("no {}", option);
  std::string text;
  for (const std::string& value : values)
    text += fmt::format("{}{} {}", text.empty() ? "" : " ", option, printable(value));
  return text;
}

std::string frames_text(const std::optional<TakeFrames>& frames) {
  return frames ? fmt::format("--frames {}:{}", frames->first, frames->last) : "no --frames";
}

std::string one_text(std::string_view option, const std::string& value) {
  return value.empty() ? fmt::format("no {}", option)
                       : fmt::format("{} {}", option, printable(value));
}

}  // namespace

Result<bool> write_sweep_file(const SweepFile& content, const std::filesystem::path& file,
                              const StopRequest& should_stop) {
  auto opened = AtomicFile::create(file);
  if (!opened) return fail(opened.error());
  JsonFile out(*opened, should_stop);
  try {
    write_content(content, out);
  } catch (const FileJson::exception&) {
    return fail(ErrorCode::InvalidInput,
                "the names and values of a sweep must be UTF-8, but one is not");
  }
  if (auto written = out.finish(); !written) return fail(written.error());
  return opened->commit_new();
}

Result<SweepFile> read_sweep_file(const std::filesystem::path& file,
                                  const StopRequest& should_stop) {
  std::error_code error;
  if (const auto status = std::filesystem::status(file, error);
      std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    return fail(ErrorCode::InvalidInput, "is no regular file", file.string());
  if (const auto size = std::filesystem::file_size(file, error);
      !error && size > largest_sweep_file)
    return fail(
        ErrorCode::InvalidInput,
        fmt::format("is larger than {} MiB, more than a sweep can have", largest_sweep_file >> 20U),
        file.string());
  auto text = read_file(file, largest_sweep_file, should_stop);
  if (!text) return fail(text.error());
  const auto refuse = [&](std::string_view reason) {
    return fail(
        ErrorCode::InvalidInput,
        fmt::format("is not the file of a sweep that this pliant can read: {}", printable(reason)),
        file.string());
  };
  try {
    Stops stops(should_stop);
    AxisTexts texts;
    const char* const end = text->data() + text->size();
    FileJson json = FileJson::parse(StoppingText(text->data(), end, stops),
                                    StoppingText(end, end, stops), std::ref(texts), false);
    if (stops.is_stopped()) return interrupted();
    if (json.is_discarded()) return refuse("it is no JSON");
    *text = std::string();
    return content_of(std::move(json), texts.take());
  } catch (const FileJson::exception&) {
    return refuse("a member is missing, or has a value of another kind");
  } catch (const std::exception& error) {
    return refuse(error.what());
  }
}

std::string difference_of(const SweepFile& there, const SweepFile& asked) {
  const SweepRequest &a = there.request, &b = asked.request;
  const auto differ = [](const std::string& one, const std::string& other) {
    return one == other ? std::string() : fmt::format("{}, not {}", one, other);
  };
  const auto samples = [](const SweepRequest& request) {
    return request.variation.samples ? fmt::format("--sample {}", *request.variation.samples)
                                     : std::string("no --sample");
  };
  const auto table = [](const SweepFile& file) {
    return file.table_hash.empty()
               ? std::string("no --takes")
               : fmt::format("a table --takes with the hash {}", file.table_hash);
  };
  const std::string differences[] = {
      differ("engine " + there.engine, "engine " + asked.engine),
      differ(options_text("SCENE", a.scenes), options_text("SCENE", b.scenes)),
      differ(options_text("--vary", a.variation.vary), options_text("--vary", b.variation.vary)),
      differ(options_text("--set", a.variation.set), options_text("--set", b.variation.set)),
      differ(samples(a), samples(b)),
      differ(table(there), table(asked)),
      differ(frames_text(a.frames), frames_text(b.frames)),
      differ(fmt::format("--solver {}", name_of(a.solver)),
             fmt::format("--solver {}", name_of(b.solver))),
      differ(one_text("--root", a.root), one_text("--root", b.root)),
      differ(one_text("--write", a.write), one_text("--write", b.write))};
  for (const std::string& difference : differences)
    if (!difference.empty()) return difference;
  for (std::size_t k = 0; k < there.texts.size(); ++k) {
    const SceneTexts &one = there.texts[k], &other = asked.texts[k];
    if (auto difference = differ(printable(one.file), printable(other.file)); !difference.empty())
      return "the scene " + difference;
    if (one.text != other.text) return fmt::format("another text of {}", printable(one.file));
    for (std::size_t n = 0; n < std::max(one.included.size(), other.included.size()); ++n) {
      if (n >= one.included.size() || n >= other.included.size() ||
          one.included[n].path != other.included[n].path)
        return fmt::format("other files that {} includes", printable(one.file));
      if (one.included[n].text != other.included[n].text)
        return fmt::format("another text of {}", printable(one.included[n].path));
    }
  }
  return {};
}

}  // namespace pliant
