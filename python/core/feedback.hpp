#pragma once

#include "call.hpp"

namespace pliant::python {

/// Adds previews and suggestions.
void add_feedback(Module& module);

}  // namespace pliant::python
