#pragma once

#include <cstddef>
#include <vector>

#include "pliant/timeline/key.hpp"
#include "pliant/timeline/key_search.hpp"
#include "pliant/timeline/segment.hpp"

namespace pliant::timeline {

/// The side from which a frame is approached: at a key the results may differ.
enum class Limit { At, Left, Right };

/// The compiled keys of a curve: its values from the first key to the last. Extrapolated gives the
/// values outside.
template <int D>
struct Track {
  std::vector<double> frames;        ///< of the keys, strictly increasing, at least one
  std::vector<Value<D>> values;      ///< of the keys
  std::vector<Value<D>> arrivals;    ///< end value of the segment before a key; first: its `left`
  KeySearch search;                  ///< over `frames`
  std::vector<Segment<D>> segments;  ///< one fewer than keys
  std::vector<TimeCubic> times;      ///< of the Bézier segments
  std::vector<Easings<D>> easings;   ///< of the easing segments

  double first() const { return frames.front(); }
  double last() const { return frames.back(); }

  /// The segment that contains a frame; at a key, the later one. Requires: first() <= frame.
  std::size_t segment_at(double frame) const { return search.segment_at(frames, frame); }

  // Below, `segment` is segment_at(frame), and first() <= frame <= last(). With one key there is no
  // segment: frame is its frame, and only value() may be called.

  /// The value, or its limit from one side (Left: not at the first key; Right: not at the last).
  Value<D> value(double frame, Limit limit, std::size_t segment) const;

  /// The value inside a segment, away from its keys. Defined in track_evaluation.hpp.
  inline Value<D> value_in(const Segment<D>& segment, double frame) const;

  /// The slope just beside a frame (Left: not at the first key; Right: not at the last).
  Value<D> velocity(double frame, Limit limit, std::size_t segment) const;

  /// Frames from..to between the keys, with or without the values exactly on its two ends.
  struct Interval {
    double from = 0;
    double to = 0;
    bool holds_from = true;
    bool holds_to = true;
  };

  /// Extends `bounds` to every value in an interval, including the one-sided limits inside.
  void add_bounds(const Interval& interval, Bounds<D>& bounds) const;

 private:
  Value<D> careful_value_in(const Segment<D>& segment, double frame) const;
  Value<D> velocity_in(const Segment<D>& segment, double frame) const;
  void add_extrema(const Segment<D>& segment, double from, double to, Bounds<D>& bounds) const;
};

extern template struct Track<1>;
extern template struct Track<3>;

}  // namespace pliant::timeline
