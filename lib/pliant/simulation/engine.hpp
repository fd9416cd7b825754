#pragma once

#include <string_view>

namespace pliant {

/// Names the arithmetic that this library was built from: a digest of the sources of all rooms on
/// the way to a state, and of the headers of the libraries that they calculate with. States of
/// engines of one name have the same bits. Not for other rooms.
std::string_view engine_name();

}  // namespace pliant
