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

  /// Waits until it has read all bytes. Errors: Unwritable with ffmpeg's message if it ended;
  /// Interrupted.
  Result<void> write(std::string_view bytes);
  /// Ends the input and waits until ffmpeg has finished. Errors: as for `write`.
  Result<void> finish();

 private:
  Ffmpeg(KeptProgram program, OpenDescriptor input, std::string log)
      : program_(std::move(program)), input_(std::move(input)), log_(std::move(log)) {}

  tl::unexpected<Error> failure() const;

  KeptProgram program_;  // its incomplete output is useless
  OpenDescriptor input_;
  std::string log_;
};

}  // namespace pliant::cli
