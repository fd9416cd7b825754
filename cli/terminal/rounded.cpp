#include "cli/terminal/rounded.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pliant/core/text.hpp"

namespace pliant::cli {

std::string rounded(double value) { return fmt::format("{}", with_digits(value + 0.0, 3)); }

std::string place_text(const Vector3d& at, double size) {
  const double power = size > 0 ? std::floor(std::log10(size)) : 0;
  const int digits = static_cast<int>(std::clamp(3 - power, 0.0, 300.0));
  std::vector<std::string> words;
  for (const double number : at) {
    const std::string text = fmt::format("{:.{}f}", number, digits);
    words.push_back(fmt::format("{}", std::strtod(text.c_str(), nullptr) + 0.0));
  }
  return fmt::format("{}", fmt::join(words, " "));
}

std::string precision_text(const std::string& what, std::string_view formats,
                           const PrecisionLoss& loss, const Vector3d& there) {
  return fmt::format(
      "{} is so far from the origin that the single precision of {} moves its vertices by up to "
      "{:.2g}, {:.2g} % of its size; <transform translate=\"{}\"/> brings it to the origin, if its "
      "forces move along, and .npy, .obj and .ply have double precision",
      what, formats, loss.error, 100 * loss.error / loss.size,
      place_text(there - loss.centre, 1000 * loss.size));
}

}  // namespace pliant::cli
