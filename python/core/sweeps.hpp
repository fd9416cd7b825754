#pragma once

#include "call.hpp"

namespace pliant::python {

/// Adds `SweepCore` and `SweepFolderCore`: sweeps in memory and in folders.
void add_sweeps(Module& module);

}  // namespace pliant::python
