#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/files/open_file.hpp"

namespace pliant {

/// The lines of a file, read in pieces, so that a file of any size needs the memory of one line.
/// Internal to the library.
class LineReader {
 public:
  struct Line {
    std::string_view text;  ///< without its end; valid until the next call
    bool is_whole = true;   ///< false: the last one, without a line end
  };

  /// What to do with lines that are too long: to pass them over as if they were not there, or not.
  enum class LongLines { Refuse, Skip };

  /// Begins at the byte `begin` with a line. `longest`: of lines [bytes]. Errors: Unreadable;
  /// Interrupted.
  static Result<LineReader> open(const std::filesystem::path& file, std::size_t longest,
                                 LongLines long_lines = LongLines::Refuse, std::uintmax_t begin = 0,
                                 const StopRequest& should_stop = {});

  /// Whether the next line begins with a text, ahead of reading all of it. Errors: Unreadable;
  /// Interrupted.
  Result<bool> begins_with(std::string_view text, const StopRequest& should_stop = {});

  /// The next line; null: there is none. Errors: Unreadable; InvalidInput, naming file and line: it
  /// is too long, or it has NUL bytes and more than 256 KiB, as a hole of a file has. Interrupted.
  Result<std::optional<Line>> next(const StopRequest& should_stop = {});

  int line() const { return line_; }                 ///< the number of the last line, from 1
  std::uintmax_t position() const { return next_; }  ///< where the next line begins [bytes]

 private:
  LineReader(OpenDescriptor file, std::string name, std::size_t longest, LongLines long_lines,
             std::uintmax_t begin);
  void count_line();
  Result<bool> read_more(const StopRequest& should_stop);
  tl::unexpected<Error> cannot_read(int error) const;

  OpenDescriptor file_;
  std::string name_;
  std::size_t longest_;
  LongLines long_lines_;
  std::string bytes_;      // read and not forgotten yet
  std::size_t begin_ = 0;  // of the next line, in them
  std::uintmax_t next_;
  int line_ = 0;
};

}  // namespace pliant
