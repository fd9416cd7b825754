#pragma once

#include <cstddef>

#include <fmt/format.h>

#include "pliant/core/result.hpp"

namespace pliant {

/// How deep the parts of a mesh file may lie within each other: assimp follows them by calling
/// itself, to the end of the stack.
constexpr std::size_t deepest_nesting = 200;

inline tl::unexpected<Error> too_deep() {
  return fail(ErrorCode::InvalidInput,
              fmt::format("the file nests its parts more than {} deep", deepest_nesting));
}

}  // namespace pliant
