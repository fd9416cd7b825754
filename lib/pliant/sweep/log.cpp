#include "pliant/sweep/log.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <limits>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "pliant/core/hash.hpp"
#include "pliant/core/shortened.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/files/json/json_reader.hpp"
#include "pliant/files/line_reader.hpp"

namespace pliant {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// What a line of JSON costs to read is 100 times its length. Ours have less than 50 KiB.
constexpr std::size_t longest_line = std::size_t{1} << 18U;

std::string host_name() {
  char name[256] = {};
  if (gethostname(name, sizeof name - 1) != 0 || name[0] == '\0') return "unknown";
  return name;
}

std::string now_in_utc() {
  const auto now = std::chrono::system_clock::now();
  const auto milliseconds =
      std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch()).count();
  const std::time_t seconds = static_cast<std::time_t>(milliseconds / 1000);
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(seconds), milliseconds % 1000);
}

std::string in_json(const std::string& text) {
  return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

tl::unexpected<Error> cannot_write_log(const std::string& name, int error) {
  return fail(ErrorCode::Unwritable, std::string("cannot write the log: ") + std::strerror(error),
              name);
}

// The error of reading a line, with what to do about a file that is none of ours.
Error no_log(Error error) {
  if (error.code == ErrorCode::InvalidInput)
    error.message += ", so that the file is not the log of a sweep; move it away";
  return error;
}

Result<std::vector<fs::path>> files_of_log(const fs::path& folder, const StopRequest& should_stop) {
  std::error_code error;
  std::vector<fs::path> files;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (is_stopped(should_stop)) return interrupted();
    std::error_code unknown;
    if (entry->path().extension() == ".jsonl" && entry->is_regular_file(unknown))
      files.push_back(entry->path());
  }
  if (error && error != std::errc::no_such_file_or_directory)
    return fail(ErrorCode::Unreadable, error.message(), folder.string());
  std::sort(files.begin(), files.end());
  return files;
}

// 0: unknown.
std::uintmax_t size_of(const fs::path& file) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  return error ? 0 : size;
}

// Reads what a line has.
class LineContent : private JsonReader {
 public:
  explicit LineContent(Json& root) : JsonReader(root) {}

  // False: it has another form.
  bool read(LogLine& line) {
    line.take = required_whole(root_, "take");
    const std::string status = required_text(root_, "status");
    line.seconds = required_number(root_, "seconds");
    line.host = required_text(root_, "host");
    line.time = required_text(root_, "time");
    line.is_done = status == "done";
    if (line.is_done) {
      line.measures = measures();
    } else if (status == "failed") {
      line.error = required_text(root_, "error");
      line.full_error = text(root_, "fullError").value_or(line.error);
    } else {
      return false;
    }
    // Ours are no longer, and a host has no more than 255 bytes.
    const bool is_ours = line.error.size() <= longest_error_text &&
                         line.full_error.size() <= longest_error_text && line.host.size() <= 255 &&
                         line.time.size() <= 64;
    return is_ours && !fault_;
  }

 private:
  Measures measures() {
    return {.peak = required_number(root_, "peak"),
            .peak_frame = required_int(root_, "peakFrame"),
            .final = required_number(root_, "final"),
            .rms = required_number(root_, "rms"),
            .speed = required_number(root_, "speed"),
            .energy = required_number(root_, "energy"),
            .settle = required_int(root_, "settle"),
            .hash = required_hash(root_, "hash")};
  }
};

}  // namespace

std::string error_text(const Error& error, Folders folders) {
  std::string text;
  const auto add = [&](const Error& one) {
    if (!text.empty()) text += "; ";
    if (!one.file.empty()) {
      text += folders == Folders::With ? one.file : fs::path(one.file).filename().string();
      if (one.line > 0) text += fmt::format(":{}", one.line);
      text += ": ";
    }
    text += one.message;
  };
  add(error);
  for (const Error& other : error.others)
    if (text.size() < longest_error_text) add(other);
  return shortened(printable(text), longest_error_text);
}

std::string to_line(const TakeOutcome& outcome) {
  std::string line = fmt::format("{{\"take\":{},", outcome.take);
  if (outcome.measures) {
    const Measures& m = *outcome.measures;
    line += fmt::format(
        "\"status\":\"done\",\"peak\":{},\"peakFrame\":{},\"final\":{},\"rms\":{},\"speed\":{},"
        "\"energy\":{},\"settle\":{},\"hash\":\"{}\"",
        m.peak, m.peak_frame, m.final, m.rms, m.speed, m.energy, m.settle, to_text(m.hash));
  } else {
    const Error& error = outcome.measures.error();
    line += fmt::format("\"status\":\"failed\",\"error\":{},\"fullError\":{}",
                        in_json(error_text(error, Folders::Without)),
                        in_json(error_text(error, Folders::With)));
  }
  return line + fmt::format(",\"seconds\":{:.6f},\"host\":{},\"time\":\"{}\"}}\n", outcome.seconds,
                            in_json(host_name()), now_in_utc());
}

bool read_line(std::string_view text, LogLine& line) {
  auto json = parse_json(text, "a line of a log");
  return json && json->is_object() && LineContent(*json).read(line);
}

Result<void> make_own_folder(const fs::path& folder) {
  std::error_code error;
  if (fs::is_symlink(folder, error))
    return fail(
        ErrorCode::InvalidInput,
        "is a symbolic link, but a sweep writes only to its own folder; put a folder in its "
        "place, or make the sweep where the link leads",
        folder.string());
  fs::create_directory(folder, error);
  if (error)
    return fail(ErrorCode::Unwritable, "cannot make the folder: " + error.message(),
                folder.string());
  return {};
}

LogFile::~LogFile() {
  if (descriptor_.is_open()) fsync(descriptor_.number());
}

Result<LogFile> LogFile::create(const fs::path& folder) {
  if (auto made = make_own_folder(folder); !made) return fail(made.error());
  std::string host = host_name();
  std::replace(host.begin(), host.end(), '/', '-');
  for (int attempt = 0; attempt < 1000; ++attempt) {
    const auto moment = std::chrono::system_clock::now().time_since_epoch().count();
    const fs::path file =
        folder / fmt::format("{}-{}-{}-{}.jsonl", host, getpid(), moment, attempt);
    const int descriptor =
        open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666);
    if (descriptor >= 0) return LogFile(descriptor, file.string());
    if (errno != EEXIST) return cannot_write_log(file.string(), errno);
  }
  return cannot_write_log(folder.string(), EEXIST);
}

Result<void> LogFile::append(std::string_view line) {
  for (;;) {
    const ssize_t count = write(descriptor_.number(), line.data(), line.size());
    if (count == static_cast<ssize_t>(line.size())) return {};
    if (count < 0 && errno == EINTR) continue;
    return cannot_write_log(name_, count < 0 ? errno : ENOSPC);
  }
}

Result<void> LogReader::skip(const StopRequest& should_stop) {
  const auto files = files_of_log(folder_, should_stop);
  if (!files) return fail(files.error());
  for (const fs::path& file : *files) {
    if (is_stopped(should_stop)) return interrupted();
    const std::uintmax_t size = size_of(file);
    places_[file] = {size, size};
  }
  return {};
}

Result<void> LogReader::read(const std::function<void(LogLine)>& take_line,
                             const StopRequest& should_stop) {
  const auto files = files_of_log(folder_, should_stop);
  if (!files) return fail(files.error());
  for (const fs::path& file : *files) {
    if (is_stopped(should_stop)) return interrupted();
    Place& place = places_[file];
    const std::uintmax_t size = size_of(file);
    if (size == place.size) continue;
    if (size < place.size) place = {};  // another file by now
    auto lines =
        LineReader::open(file, longest_line, LineReader::LongLines::Skip, place.next, should_stop);
    if (!lines) return fail(lines.error());
    for (std::size_t count = 0;; ++count) {
      if (is_stopped(should_stop, count)) return interrupted();
      const auto line = lines->next(should_stop);
      if (!line) return fail(no_log(line.error()));
      place.size = lines->position() + (*line && !(*line)->is_whole ? (*line)->text.size() : 0);
      if (!*line || !(*line)->is_whole) break;
      LogLine read;
      if (read_line((*line)->text, read)) take_line(std::move(read));
      place.next = lines->position();
    }
  }
  return {};
}

}  // namespace pliant
