#pragma once

#include <string_view>

#include "pliant/core/result.hpp"

namespace pliant::cli {

/// From now on the first Ctrl-C, SIGTERM or SIGHUP is noted instead of ending the program, so that
/// it can remove what is half written; a second one ends it. And a file that may not grow any more
/// is an error of the write, not the end of the program.
void catch_interrupts();

/// Ahead of all else: standard streams that are closed are opened to nothing, so that no file of
/// ours takes their numbers and what we print with them; and that nobody reads what we print is an
/// error of the write, not the end of the program.
void own_standard_streams();

bool was_interrupted();

/// The error of an interrupted run with what of it can be kept, "interrupted at frame 12; KEPT";
/// any other error as it is.
Error with_kept(Error error, std::string_view kept);

}  // namespace pliant::cli
