#include "pliant/exchange/single.hpp"

#include <cmath>

#include <fmt/format.h>

#include "pliant/core/text.hpp"

namespace pliant::exchange {

double shortest_of_single(double value) {
  const auto single = static_cast<float>(value);
  if (static_cast<double>(single) != value) return value;
  return to_number(fmt::format("{}", single)).value_or(value);
}

float seconds_of_frame(double frame, double fps, double frame_at_zero) {
  return static_cast<float>((frame - frame_at_zero) / fps);
}

double frame_of_seconds(double seconds, double fps, double frame_at_zero) {
  const double exact = frame_at_zero + seconds * fps;
  if (!std::isfinite(exact) || std::fabs(seconds) > 1e30) return exact;
  double scale = 1;
  for (int digits = 0; digits <= 6; ++digits, scale *= 10) {
    const double frame = std::round(exact * scale) / scale;
    if (static_cast<double>(seconds_of_frame(frame, fps, frame_at_zero)) == seconds) return frame;
  }
  return exact;
}

}  // namespace pliant::exchange
