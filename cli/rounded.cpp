#include "rounded.hpp"

#include <fmt/format.h>

#include "pliant/core/text.hpp"

namespace pliant::cli {

std::string rounded(double value) { return fmt::format("{}", with_digits(value + 0.0, 3)); }

}  // namespace pliant::cli
