#pragma once

#include <string>

#include "pliant/core/field.hpp"

namespace pliant::cli {

/// A number with three digits, as a person would write it into a scene.
std::string rounded(double value);

/// A place, to a thousandth of `size`, such as that of the box that it is in: as many digits as
/// tell places in it apart, however far it is from the origin.
std::string place_text(const Vector3d& at, double size);

}  // namespace pliant::cli
