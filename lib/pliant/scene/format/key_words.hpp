#pragma once

#include <string>

#include "pliant/timeline/key.hpp"

namespace pliant::xml {

/// How the values of a channel's keys are written.
enum class ValueKind {
  Number,
  Vector,   ///< three numbers
  Widened,  ///< three numbers, or one that stands for all three
  Boolean,  ///< `true` or `false`, kept as 1 and 0
};

// What a file has for the parts of a <key> and of an <animate>.

/// `linear`, `elasticOut`: without the parameters.
std::string text_of(const Interpolation& interpolation);

/// `auto`, or the slope: without the length. Empty for a handle, which has attributes of its own.
template <int D>
std::string text_of(const Tangent<D>& tangent, ValueKind kind);

/// `hold`, `slope 0.5`, `repeat 2`.
template <int D>
std::string text_of(const Extrapolation<D>& extrapolation, ValueKind kind);

}  // namespace pliant::xml
