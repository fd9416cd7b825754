#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "pliant/output/atomic_file.hpp"
#include "pliant/replay/log.hpp"

namespace pliant {

/// Writes a .replay file; it appears whole or not at all. docs/replay.md.
class ReplayLogWriter {
 public:
  /// Errors: Unwritable.
  static Result<ReplayLogWriter> create(const std::filesystem::path& file,
                                        const ReplayHeader& header);

  /// Writes the next frame. Requires: its surfaces, and its states if it has any, are those of the
  /// header. Errors: Unwritable.
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
  /// another format version, and a header that was changed.
  static Result<ReplayLogReader> open(const std::filesystem::path& file);

  const ReplayHeader& header() const { return header_; }

  /// The next frame; nullopt after the last one. Errors, with the line: InvalidInput if the line
  /// was changed after recording, or if the log is truncated.
  Result<std::optional<ReplayFrame>> next();

 private:
  ReplayLogReader(std::string name, std::ifstream stream);
  Result<std::string> next_line();
  Result<void> read_header();
  Result<void> read_end(long frame_count);
  tl::unexpected<Error> at_fault(std::string message) const;

  std::string name_;
  std::ifstream stream_;
  int line_ = 0;
  std::string seal_;
  ReplayHeader header_;
  long frame_count_ = 0;  // frames read so far
  bool is_at_end_ = false;
};

}  // namespace pliant
