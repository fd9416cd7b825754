#pragma once

namespace pliant::cli {

/// From now on the first Ctrl-C, SIGTERM or SIGHUP is noted instead of ending the program, so that
/// it can remove what is half written; a second one ends it. And a file that may not grow any more
/// is an error of the write, not the end of the program.
void catch_interrupts();

/// From now on it is no reason to end that nobody reads what we print: for commands whose product
/// is a file.
void outlive_readers();

bool was_interrupted();

}  // namespace pliant::cli
