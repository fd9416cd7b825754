#pragma once

#include <string>
#include <string_view>

#include "pliant/core/field.hpp"
#include "pliant/files/writer.hpp"

namespace pliant::cli {

/// A number with three digits, as a person would write it into a scene.
std::string rounded(double value);

/// A place, to a thousandth of `size`, such as that of the box that it is in: as many digits as
/// tell places in it apart, however far it is from the origin.
std::string place_text(const Vector3d& at, double size);

/// What is too far from the origin for the single precision of some formats, and what helps.
/// `there` is where its <transform> moves it already.
std::string precision_text(const std::string& what, std::string_view formats,
                           const PrecisionLoss& loss, const Vector3d& there);

}  // namespace pliant::cli
