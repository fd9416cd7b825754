#pragma once

#include <algorithm>

#include "pliant/timeline/track.hpp"

namespace pliant::timeline {

/// The place of a frame in a segment whose time is linear, counted from the nearer end.
struct LinearPlace {
  int end;
  double q;

  template <int D>
  static LinearPlace of(const Segment<D>& segment, double frame) {
    const double passed = frame - segment.start;
    const double left = segment.end - frame;
    return {passed > left ? 1 : 0, std::min(passed, left) / segment.length};
  }
};

// Inline, since playback spends most of its time here. Not part of track.hpp: otherwise it could be
// compiled with flags of a program that uses the library, which might change its bits.
template <int D>
inline Value<D> Track<D>::value_in(const Segment<D>& segment, double frame) const {
  Value<D> value;
  LinearPlace place = {0, 0};
  if (segment.kind == Segment<D>::Kind::Bezier) {
    // One solve for all components.
    const TimeCubic::Place found = times[segment.extra].quick_place_of(frame);
    if (!(found.q > 0)) return careful_value_in(segment, frame);
    place = {found.end, found.q};
  } else if (segment.kind == Segment<D>::Kind::Easing) {
    return careful_value_in(segment, frame);
  } else {
    place = LinearPlace::of(segment, frame);
  }
  for (int c = 0; c < D; ++c) value[c] = segment.ends[place.end][c].value(place.q);
  return value;
}

}  // namespace pliant::timeline
