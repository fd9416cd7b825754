#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <sys/types.h>

#include "pliant/core/result.hpp"

namespace pliant::cli {

/// A running ffmpeg, which reads bytes from its standard input; killed by the destructor.
class Ffmpeg {
 public:
  /// `words` are arguments after those of all runs: no questions, errors only. Its messages are
  /// written to the file `log`. Errors: Unwritable if there is no ffmpeg.
  static Result<Ffmpeg> start(const std::vector<std::string>& words, const std::string& log);

  Ffmpeg(Ffmpeg&& other) noexcept;
  Ffmpeg& operator=(Ffmpeg&&) = delete;
  ~Ffmpeg();

  /// Waits until it has read all bytes. Errors: Unwritable with ffmpeg's message if it ended;
  /// Interrupted.
  Result<void> write(std::string_view bytes);
  /// Ends the input and waits until ffmpeg has finished. Errors: as for `write`.
  Result<void> finish();

 private:
  Ffmpeg(pid_t id, int input, std::string log) : id_(id), input_(input), log_(std::move(log)) {}

  void close_input();
  tl::unexpected<Error> failure() const;

  pid_t id_;   // 0: it has ended
  int input_;  // -1: closed
  std::string log_;
};

}  // namespace pliant::cli
