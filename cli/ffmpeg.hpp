#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <sys/types.h>

#include "pliant/core/result.hpp"

namespace pliant::cli {

/// Whether there is a program of that name on the PATH.
bool is_on_path(std::string_view program);

/// A run of ffmpeg, which takes bytes on its standard input; ended with its owner. It is another
/// program, started with its words one by one and never through a shell.
class Ffmpeg {
 public:
  /// `words` come after those that all runs have: no questions, errors only. What it has to say
  /// goes to the file `log`. Errors: Unwritable, if there is no ffmpeg.
  static Result<Ffmpeg> start(const std::vector<std::string>& words, const std::string& log);

  Ffmpeg(Ffmpeg&& other) noexcept;
  Ffmpeg& operator=(Ffmpeg&&) = delete;
  ~Ffmpeg();

  /// Waits until it has taken all of it. Errors: Unwritable with what ffmpeg said, if it ended;
  /// Interrupted.
  Result<void> write(std::string_view bytes);
  /// No more is to come: waits until it is done. Errors: as for `write`.
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
