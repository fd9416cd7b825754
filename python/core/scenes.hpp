#pragma once

#include "call.hpp"

namespace pliant::python {

/// Adds what reads, checks, changes and writes scenes.
void add_scenes(Module& module);

}  // namespace pliant::python
