#pragma once

#include <optional>
#include <string>

namespace pliant::cli {

/// Frames per second as a fraction, as programs that write movies need it.
struct FrameRate {
  int frames = 0;
  int seconds = 1;

  friend bool operator==(const FrameRate&, const FrameRate&) = default;
};

/// The range of rates for movies. [frames/s]
inline constexpr double least_rate = 0.01;
inline constexpr double most_rate = 1000;

/// The simplest fraction whose double quotient is `fps`, such as 24000/1001; if that needs numbers
/// above 10^6, one that is within a millionth of it. Null: outside the range for movies.
std::optional<FrameRate> frame_rate(double fps);

/// "24", "24000/1001"
std::string to_text(const FrameRate& rate);

}  // namespace pliant::cli
