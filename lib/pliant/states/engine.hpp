#pragma once

#include <string_view>

namespace pliant {

/// Identifies the arithmetic of this library: a digest of the sources of all rooms that take part
/// in computing a state, and of the libraries that they compute with. Engines of the same name give
/// states with the same bits. Not for programs.
std::string_view engine_name();

}  // namespace pliant
