#include "cli/commands/frame_rate.hpp"

#include <cmath>

#include <fmt/format.h>

namespace pliant::cli {

std::optional<FrameRate> frame_rate(double fps) {
  if (!(fps >= least_rate && fps <= most_rate)) return std::nullopt;
  constexpr double most = 1'000'000;
  // The convergents of the continued fraction, each nearer than the previous one.
  double numerator = 1, denominator = 0, earlier_numerator = 0, earlier_denominator = 1;
  for (double rest = fps;;) {
    const double whole = std::floor(rest);
    const double next_numerator = whole * numerator + earlier_numerator;
    const double next_denominator = whole * denominator + earlier_denominator;
    if (next_numerator > most || next_denominator > most) break;
    earlier_numerator = numerator;
    earlier_denominator = denominator;
    numerator = next_numerator;
    denominator = next_denominator;
    if (numerator / denominator == fps || rest == whole) break;
    rest = 1 / (rest - whole);
  }
  return FrameRate{static_cast<int>(numerator), static_cast<int>(denominator)};
}

std::string to_text(const FrameRate& rate) {
  return rate.seconds == 1 ? fmt::format("{}", rate.frames)
                           : fmt::format("{}/{}", rate.frames, rate.seconds);
}

}  // namespace pliant::cli
