#pragma once

#include "call.hpp"

namespace pliant::python {

/// Adds `Document`, what edits are made of, and the formats of operations.
void add_documents(Module& module);

}  // namespace pliant::python
