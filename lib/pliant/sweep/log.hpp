#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/files/open_file.hpp"
#include "pliant/sweep/sweep.hpp"

namespace pliant {

// The log of a sweep: lines of JSON, one for each take that ended. Internal to sweep.

/// A line of the log.
struct LogLine {
  std::size_t take = 0;
  bool is_done = false;
  Measures measures = {};       ///< of a take that is done
  std::string error = {};       ///< of one that failed, as in the table
  std::string full_error = {};  ///< the same with the folders of files
  double seconds = 0;
  std::string host = {};
  std::string time = {};  ///< when it ended: UTC, 2026-11-24T10:45:00.123Z
};

/// The line for an outcome that ends now, with its line end.
std::string to_line(const TakeOutcome& outcome);

/// Whether the text of an error has the folders of its files. Without them it does not depend on
/// where a sweep is.
enum class Folders { Without, With };

/// The text of an error in the log: FILE:LINE: MESSAGE, with those found with it, at most
/// `longest_error_text` bytes.
std::string error_text(const Error& error, Folders folders);

inline constexpr std::size_t longest_error_text = 8192;

/// Reads a line; false: it is not a whole one.
bool read_line(std::string_view text, LogLine& line);

/// One writer's file.
class LogFile {
 public:
  /// A file of its own in the folder, which is made if necessary. Errors: Unwritable.
  static Result<LogFile> create(const std::filesystem::path& folder);

  LogFile(LogFile&&) noexcept = default;
  LogFile& operator=(LogFile&&) = delete;
  ~LogFile();

  /// Appends a line by one write. Errors: Unwritable; then nothing more can be appended.
  Result<void> append(std::string_view line);

 private:
  LogFile(int descriptor, std::string name) : descriptor_(descriptor), name_(std::move(name)) {}

  OpenDescriptor descriptor_;
  std::string name_;
};

/// Makes a folder within that of a sweep, if it is not there. Errors: InvalidInput: a link is in
/// its place, which may lead anywhere if the sweep is a stranger's; Unwritable.
Result<void> make_own_folder(const std::filesystem::path& folder);

/// Reads a log while others write it.
class LogReader {
 public:
  explicit LogReader(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Passes over all that is there. Errors: Unreadable; Interrupted.
  Result<void> skip(const StopRequest& should_stop = {});

  /// Calls `take_line` for each whole line of all files of the folder, which may be missing, that
  /// was not read before; a line that is none of a log is passed over. Costs a look at each file,
  /// and what was added. Errors: Unreadable; InvalidInput, with file and line: a hole of
  /// more than 256 KiB; Interrupted.
  Result<void> read(const std::function<void(LogLine)>& take_line,
                    const StopRequest& should_stop = {});

 private:
  struct Place {
    std::uintmax_t next = 0;  // where the next line begins
    std::uintmax_t size = 0;  // of the file, when it was read
  };

  std::filesystem::path folder_;
  std::map<std::filesystem::path, Place> places_;  // of each file
};

}  // namespace pliant
