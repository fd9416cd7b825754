#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "pliant/core/stop_request.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/files/line_reader.hpp"
#include "pliant/replay/log.hpp"

namespace pliant {

/// Writes a .replay file; it appears whole or not at all. docs/replay.md.
class ReplayLogWriter {
 public:
  /// Errors: Unwritable; InvalidInput: as `write`.
  static Result<ReplayLogWriter> create(const std::filesystem::path& file,
                                        const ReplayHeader& header);

  /// Writes the next frame. Requires: its surfaces, and its states if it has any, are those of the
  /// header. Errors: Unwritable; InvalidInput: it is larger than a line that is read.
  Result<void> write(const ReplayFrame& frame);

  /// Errors: Unwritable. Requires: all frames of the header are written.
  Result<void> finish();

 private:
  explicit ReplayLogWriter(AtomicFile file) : file_(std::move(file)) {}
  Result<void> write_line(std::string json);

  AtomicFile file_;
  std::string seal_;
  long frame_count_ = 0;
};

/// Reads a .replay file frame by frame; only one is in memory at a time.
class ReplayLogReader {
 public:
  /// Reads the header. Errors: Unreadable; InvalidInput for a file that is not a log, a log of
  /// another format version, and a header that was changed. Interrupted.
  static Result<ReplayLogReader> open(const std::filesystem::path& file,
                                      const StopRequest& should_stop = {});

  const ReplayHeader& header() const { return header_; }

  /// The next frame; nullopt after the last one. Errors, with the line: InvalidInput if the line
  /// was changed after recording, or if the log is truncated. Interrupted.
  Result<std::optional<ReplayFrame>> next(const StopRequest& should_stop = {});

 private:
  ReplayLogReader(std::string name, LineReader lines);
  Result<std::string_view> next_line(const StopRequest& should_stop);
  Result<void> check_seal(std::string_view line, const StopRequest& should_stop);
  Result<void> read_header(const StopRequest& should_stop);
  Result<void> read_end(std::string_view line, const StopRequest& should_stop);
  tl::unexpected<Error> at_fault(std::string message) const;
  tl::unexpected<Error> as_told(const Error& error, std::string_view what) const;

  std::string name_;
  LineReader lines_;
  std::string seal_;
  ReplayHeader header_;
  long frame_count_ = 0;  // frames read so far
  bool is_at_end_ = false;
};

}  // namespace pliant
