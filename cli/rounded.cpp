#include "rounded.hpp"

#include <cstdlib>

#include <fmt/format.h>

namespace pliant::cli {

std::string rounded(double value) {
  return fmt::format("{}", std::strtod(fmt::format("{:.2e}", value + 0.0).c_str(), nullptr));
}

}  // namespace pliant::cli
