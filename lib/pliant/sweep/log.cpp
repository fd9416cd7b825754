#include "pliant/sweep/log.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <fstream>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "pliant/core/hash.hpp"
#include "pliant/core/read_file.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/core/text.hpp"
#include "pliant/sweep/own_folder.hpp"

namespace pliant {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// What a line of JSON costs to read is 100 times its length.
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

Result<std::vector<fs::path>> files_of_log(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> files;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
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

// Passes the bytes of a file from there on to `take`, in pieces, until it returns false.
Result<void> read_from(const fs::path& file, std::uintmax_t begin,
                       const std::function<bool(std::string_view)>& take) {
  if (auto readable = check_readable(file); !readable) return readable;
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(begin));
  std::string piece(std::size_t{1} << 20U, '\0');
  do {
    stream.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    const auto count = static_cast<std::size_t>(stream.gcount());
    if (count > 0 && !take(std::string_view(piece).substr(0, count))) return {};
  } while (stream);
  if (!stream.eof()) return fail(ErrorCode::Unreadable, std::strerror(errno), file.string());
  return {};
}

// Reads a member; false: it is missing or of another type.

bool read_member(const Json& json, const char* name, std::string& text) {
  const auto found = json.find(name);
  if (found == json.end() || !found->is_string()) return false;
  text = found->get_ref<const std::string&>();
  return true;
}

bool read_member(const Json& json, const char* name, double& number) {
  const auto found = json.find(name);
  if (found == json.end() || !found->is_number()) return false;
  number = found->get<double>();
  return true;
}

bool read_member(const Json& json, const char* name, int& number) {
  const auto found = json.find(name);
  if (found == json.end() || !found->is_number_integer()) return false;
  const auto whole = found->get<std::int64_t>();
  number = static_cast<int>(whole);
  return number == whole;
}

bool read_measures(const Json& json, Measures& measures) {
  std::string hash;
  if (!read_member(json, "peak", measures.peak) ||
      !read_member(json, "peakFrame", measures.peak_frame) ||
      !read_member(json, "final", measures.final) || !read_member(json, "rms", measures.rms) ||
      !read_member(json, "speed", measures.speed) ||
      !read_member(json, "energy", measures.energy) ||
      !read_member(json, "settle", measures.settle) || !read_member(json, "hash", hash))
    return false;
  const auto read = to_hash(hash);
  if (read) measures.hash = *read;
  return read.has_value();
}

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
  text = printable(text);
  if (text.size() <= longest_error_text) return text;
  constexpr std::string_view rest = "…";
  std::size_t end = longest_error_text - rest.size();
  while (length_of_character(text.substr(end, 4)) == 0) --end;  // not within a character
  return text.substr(0, end).append(rest);
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
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) return false;
  const auto take = json.find("take");
  if (take == json.end() || !take->is_number_unsigned()) return false;
  line.take = take->get<std::size_t>();
  std::string status;
  if (!read_member(json, "status", status) || !read_member(json, "seconds", line.seconds) ||
      !read_member(json, "host", line.host) || !read_member(json, "time", line.time))
    return false;
  line.is_done = status == "done";
  if (line.is_done) return read_measures(json, line.measures);
  if (status != "failed" || !read_member(json, "error", line.error)) return false;
  if (!read_member(json, "fullError", line.full_error)) line.full_error = line.error;
  return true;
}

LogFile::LogFile(LogFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), name_(std::move(other.name_)) {}

LogFile::~LogFile() {
  if (descriptor_ < 0) return;
  fsync(descriptor_);
  close(descriptor_);
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
    const ssize_t count = write(descriptor_, line.data(), line.size());
    if (count == static_cast<ssize_t>(line.size())) return {};
    if (count < 0 && errno == EINTR) continue;
    return cannot_write_log(name_, count < 0 ? errno : ENOSPC);
  }
}

Result<void> LogReader::skip() {
  const auto files = files_of_log(folder_);
  if (!files) return fail(files.error());
  for (const fs::path& file : *files) {
    const std::uintmax_t size = size_of(file);
    places_[file] = {size, size};
  }
  return {};
}

Result<void> LogReader::read(const std::function<void(LogLine)>& take_line,
                             const StopRequest& should_stop) {
  const auto files = files_of_log(folder_);
  if (!files) return fail(files.error());
  const auto take = [&](std::string_view text) {
    LogLine line;
    if (read_line(text, line)) take_line(std::move(line));
  };
  for (const fs::path& file : *files) {
    Place& place = places_[file];
    const std::uintmax_t size = size_of(file);
    if (size == place.size) continue;
    if (size < place.size) place = {};  // another file by now
    std::string rest;                   // of a line that is not complete yet
    std::uintmax_t position = place.next;
    bool is_stopped = false;
    auto read = read_from(file, position, [&](std::string_view piece) {
      for (std::size_t end; (end = piece.find('\n')) != std::string_view::npos;
           piece.remove_prefix(end + 1)) {
        if (rest.empty()) {
          take(piece.substr(0, end));
        } else {
          rest += piece.substr(0, end);
          take(rest);
          rest.clear();
        }
        position += end + 1;
        place.next = position;
      }
      position += piece.size();
      rest += piece;
      // No line of ours; whatever follows on it is none either.
      if (rest.size() > longest_line) rest = "?";
      is_stopped = pliant::is_stopped(should_stop);
      return !is_stopped;
    });
    if (!read) return read;
    if (is_stopped) return interrupted();
    place.size = position;
  }
  return {};
}

}  // namespace pliant
