#pragma once

#include "call.hpp"

namespace pliant::python {

/// Adds what reads and writes curves of other programs.
void add_curve_files(Module& module);

}  // namespace pliant::python
