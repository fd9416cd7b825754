#pragma once

#include <optional>
#include <string>

namespace pliant::cli {

/// Frames in a second as a fraction, which programs that write movies take.
struct FrameRate {
  int frames = 0;
  int seconds = 1;

  friend bool operator==(const FrameRate&, const FrameRate&) = default;
};

/// What movies have. [frames/s]
inline constexpr double least_rate = 0.01;
inline constexpr double most_rate = 1000;

/// The simplest fraction whose double quotient is `fps`, 24000/1001 for instance; if it takes
/// numbers above 10^6, one that is within a millionth of it. None: it is not among the rates of
/// movies.
std::optional<FrameRate> frame_rate(double fps);

/// "24", "24000/1001"
std::string to_text(const FrameRate& rate);

}  // namespace pliant::cli
