#include "pliant/sweep/sweep_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "pliant/core/shortened.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/files/json/json_reader.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/files/writer.hpp"

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
      one["included"].push_back({{"path", text.path}, {"text", text.text}});
    all.push_back(std::move(one));
  }
  return all;
}

void write_content(const SweepFile& content, const TakePlan& takes, JsonFile& out) {
  FileJson json{{"sweep", format_version},
                {"version", content.version},
                {"engine", content.engine},
                {"arguments", arguments_of(content)},
                {"scenes", texts_of_scenes(content)},
                {"files", FileJson::array()},
                {"paths", FileJson::array()}};
  for (const InputHash& input : content.inputs)
    json["files"].push_back({{"file", input.file}, {"hash", to_text(input.hash)}});
  for (const VariedPath& path : takes.paths)
    json["paths"].push_back({{"path", path.path}, {"kind", word_of(path.kind)}});
  std::string head = json.dump();
  head.back() = ',';  // the axes follow
  out.text(head);
  out.text("\n\"axes\": [");
  for (std::size_t k = 0; k < takes.axes.size(); ++k) {
    const TakeAxis& axis = takes.axes[k];
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

// Several for each take: a sweep may have a million scenes, and as many meshes.
constexpr std::size_t most_values = 20'000'000;

// Takes the texts of the axes, nearly all that a large sweep has, out of the JSON while it is
// parsed.
class AxisTexts {
 public:
  Result<bool> operator()(std::span<const JsonStep> way, const std::string& text) {
    const bool is_of_axis = way.size() == 4 && way[0].key == "axes" && way[1].is_list &&
                            way[2].key == "texts" && way[3].is_list;
    if (!is_of_axis) return false;
    if (++count_ > most_take_texts) return invalid("it has too many values");
    texts_.resize(way[1].index + 1);
    texts_.back().push_back(text);
    return true;
  }

  std::vector<TextList> take() { return std::move(texts_); }

 private:
  std::vector<TextList> texts_;
  std::size_t count_ = 0;
};

// Reads what the file has, but for the texts of the axes.
class SweepFileReader : private JsonReader {
 public:
  SweepFileReader(Json& root, std::vector<TextList> texts, const StopRequest& should_stop)
      : JsonReader(root, should_stop), texts_(std::move(texts)) {}

  Result<SweepFile> read() {
    const std::int64_t version = required_integer(root_, "sweep", 0, most_whole);
    if (!fault_ && version != format_version) return invalid("another version of the format");
    SweepFile content;
    content.version = required_text(root_, "version");
    content.engine = required_text(root_, "engine");
    if (Json* const arguments = required_part(root_, "arguments"))
      within("arguments", [&] { read_arguments(*arguments, content); });
    each_required(root_, "scenes", [&](Json& json) {
      SceneTexts& texts = content.texts.emplace_back();
      texts.file = required_text(json, "file");
      texts.text = required_text(json, "text");
      each_required(json, "included", [&](Json& one) {
        texts.included.push_back({required_text(one, "path"), required_text(one, "text")});
      });
    });
    if (!fault_ && content.texts.size() != content.request.scenes.size())
      return invalid("the scenes are not complete");
    each_required(root_, "files", [&](Json& json) {
      content.inputs.push_back({required_text(json, "file"), required_hash(json, "hash")});
    });
    if (auto read = read_takes(content); !read) return fail(read.error());
    if (!fault_) return content;
    Error error = fault().value();
    if (error.code == ErrorCode::InvalidInput)
      error.message = "a member is missing, or has a value of another kind: " + error.message;
    return fail(std::move(error));
  }

 private:
  static constexpr auto most_whole = std::numeric_limits<std::int64_t>::max();

  // A member that must be there; null: it is null.
  Json* given(Json& parent, const char* key) {
    Json* const json = member(parent, key);
    if (!json) refuse(key, "is missing");
    return json && !json->is_null() ? json : nullptr;
  }

  void read_arguments(Json& json, SweepFile& content) {
    SweepRequest& request = content.request;
    request.scenes = required_texts(json, "scenes");
    request.variation.scene_count = request.scenes.size();
    request.variation.set = required_texts(json, "set");
    request.variation.vary = required_texts(json, "vary");
    if (given(json, "sample"))
      request.variation.samples = static_cast<std::size_t>(required_whole(json, "sample"));
    if (given(json, "frames")) {
      const auto frames = numbers(json, "frames", 2).value_or(std::vector<double>(2));
      for (const double frame : frames)
        if (frame != std::trunc(frame) || !(std::fabs(frame) <= std::numeric_limits<int>::max()))
          refuse("frames", "has an element that is not a frame");
      if (!fault_)
        request.frames = FrameSpan{static_cast<int>(frames[0]), static_cast<int>(frames[1])};
    }
    const auto solver = solver_choice(required_text(json, "solver"));
    if (!solver) refuse("solver", "is unknown");
    request.solver = solver.value_or(SolverChoice::Auto);
    request.root = required_text(json, "root");
    request.write = required_text(json, "write");
    // It becomes a part of file names.
    const std::string written = "takes" + request.write;
    if (!request.write.empty() && (!check_ending(written) || ending_of(written) != request.write))
      refuse("write", "is not the ending of an animation");
    content.table_hash = required_text(json, "takes");
  }

  Result<void> read_takes(SweepFile& content) {
    TakePlan& plan = content.takes;
    plan.scene_count = content.request.scenes.size();
    for (const std::string& typed : content.request.variation.set) {
      auto change = parse_change(typed);
      if (!change) return fail(change.error());
      plan.set.push_back(*std::move(change));
    }
    each_required(root_, "paths", [&](Json& json) {
      const std::string kind = required_text(json, "kind");
      plan.paths.push_back({required_text(json, "path"), kind == "*"   ? SceneChange::Kind::Times
                                                         : kind == "+" ? SceneChange::Kind::Plus
                                                                       : SceneChange::Kind::Set});
    });
    each_required(root_, "axes", [&](Json& json) {
      TakeAxis& axis = plan.axes.emplace_back();
      if (!member(json, "paths")) refuse("paths", "is missing");
      for (const std::uint64_t path : wholes(json, "paths"))
        axis.paths.push_back(static_cast<std::size_t>(path));
      axis.count = static_cast<std::size_t>(required_whole(json, "count"));
      if (!texts(json, "texts").empty()) refuse("texts", "is not a list of texts");
      if (plan.axes.size() <= texts_.size()) axis.texts = std::move(texts_[plan.axes.size() - 1]);
    });
    return {};
  }

  std::vector<TextList> texts_;
};

// `--vary a=1 --vary b=2`, or `no --vary`.
std::string options_text(std::string_view option, const std::vector<std::string>& values) {
  if (values.empty()) return fmt::format("no {}", option);
  std::string text;
  for (const std::string& value : values)
    text += fmt::format("{}{} {}", text.empty() ? "" : " ", option, value);
  return text;
}

std::string frames_text(const std::optional<FrameSpan>& frames) {
  return frames ? fmt::format("--frames {}:{}", frames->first, frames->last) : "no --frames";
}

std::string one_text(std::string_view option, const std::string& value) {
  return value.empty() ? fmt::format("no {}", option) : fmt::format("{} {}", option, value);
}

}  // namespace

Result<bool> write_sweep_file(const SweepFile& content, const TakePlan& takes,
                              const std::filesystem::path& file, const StopRequest& should_stop) {
  auto opened = AtomicFile::create(file);
  if (!opened) return fail(opened.error());
  JsonFile out(*opened, should_stop);
  try {
    write_content(content, takes, out);
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
  AxisTexts texts;
  auto json = parse_json(*text, "JSON", should_stop, most_values, std::ref(texts));
  *text = std::string();
  auto content = json ? SweepFileReader(*json, texts.take(), should_stop).read()
                      : Result<SweepFile>(fail(json.error()));
  if (content || content.error().code == ErrorCode::Interrupted) return content;
  return refuse(content.error().message);
}

std::string difference_of(const SweepFile& there, const SweepFile& asked) {
  const SweepRequest &a = there.request, &b = asked.request;
  const auto differ = [](const std::string& one, const std::string& other) {
    constexpr std::size_t longest = 1000;
    if (one == other) return std::string();
    // Of long texts only what begins with the first difference.
    const auto first = std::ranges::mismatch(one, other).in1 - one.begin();
    const bool is_long = std::max(one.size(), other.size()) > longest;
    const auto begin = is_long ? static_cast<std::size_t>(first) : 0;
    const auto told = [&](const std::string& text) {
      return (begin > 0 ? "…" : "") + shortened(printable(text.substr(begin)), longest);
    };
    return fmt::format("{}, not {}", told(one), told(other));
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
  if (there.texts.size() != asked.texts.size())
    return fmt::format("{} scenes, not {}", there.texts.size(), asked.texts.size());
  for (std::size_t k = 0; k < there.texts.size(); ++k) {
    const SceneTexts &one = there.texts[k], &other = asked.texts[k];
    if (auto difference = differ(one.file, other.file); !difference.empty())
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
