#pragma once

namespace pliant::cli {

/// From now on Ctrl-C, SIGTERM and SIGHUP are noted instead of ending the program, so that it can
/// remove what is half written; and a file that may not grow any more is an error of the write, not
/// the end of the program.
void catch_interrupts();

bool was_interrupted();

}  // namespace pliant::cli
