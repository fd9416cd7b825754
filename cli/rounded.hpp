#pragma once

#include <string>

namespace pliant::cli {

/// A number with three digits, as a person would write it into a scene.
std::string rounded(double value);

}  // namespace pliant::cli
