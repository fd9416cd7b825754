#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cli/terminal/kept_program.hpp"
#include "pliant/core/result.hpp"

namespace pliant::cli {

/// A running ffmpeg, which reads bytes from its standard input; killed by the destructor.
class Ffmpeg {
 public:
  /// `words` are arguments after those of all runs: no questions, errors only. Relative names are
  /// of files in the folder; its messages are written to the file `log` there. Errors: Unwritable
  /// if there is no ffmpeg.
  static Result<Ffmpeg> start(const std::vector<std::string>& words, const ScratchFolder& folder);

  Ffmpeg(Ffmpeg&& other) noexcept;
  Ffmpeg& operator=(Ffmpeg&&) = delete;
  ~Ffmpeg();

  /// Waits until it has read all bytes. Errors: Unwritable with ffmpeg's message if it ended;
  /// Interrupted.
  Result<void> write(std::string_view bytes);
  /// Ends the input and waits until ffmpeg has finished. Errors: as for `write`.
  Result<void> finish();

 private:
  Ffmpeg(KeptProgram program, int input, std::string log)
      : program_(std::move(program)), input_(input), log_(std::move(log)) {}

  void close_input();
  tl::unexpected<Error> failure() const;

  KeptProgram program_;  // its incomplete output is useless
  int input_;            // -1: closed
  std::string log_;
};

}  // namespace pliant::cli
