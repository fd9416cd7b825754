#pragma once

#include <string_view>

#include "pliant/core/result.hpp"

namespace pliant::cli {

/// From now on the first Ctrl-C, SIGTERM or SIGHUP sets a flag instead of ending the program, so
/// that it can remove incomplete files; a second one ends it. Under nohup a SIGHUP does nothing. A
/// file that exceeds the size limit
/// causes a write error instead of ending the program.
void catch_interrupts();

/// Call this first. Opens closed standard streams on /dev/null, so that none of our files gets
/// their descriptors and with them our prints. A closed pipe causes a write error instead of ending
/// the program.
void own_standard_streams();

/// Lets the command have as many open files as the system allows it: a .usda has three for each
/// surface until it is complete, and many systems begin with 1024 in all.
void raise_file_limit();

bool was_interrupted();

/// The error of an interrupted run followed by `kept`, "interrupted at frame 12; KEPT"; any other
/// error unchanged.
Error with_kept(Error error, std::string_view kept);

}  // namespace pliant::cli
