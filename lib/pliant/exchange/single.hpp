#pragma once

namespace pliant::exchange {

/// The double with the fewest digits that has this value in single precision, if the value is one
/// of single precision: 0.1 for 0.100000001490116. Otherwise the value itself.
double shortest_of_single(double value);

/// A time of a file in single precision as a frame: the frame with the fewest decimals, at most
/// six, that has this time.
double frame_of_seconds(double seconds, double fps, double frame_at_zero);

/// The time of a frame, in single precision [s].
float seconds_of_frame(double frame, double fps, double frame_at_zero);

}  // namespace pliant::exchange
