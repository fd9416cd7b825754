#pragma once

#include <cmath>

#include "pliant/timeline/extrapolated.hpp"

namespace pliant::timeline {

/// The frame between the keys that corresponds to a frame in a loop.
template <int D>
struct Extrapolated<D>::Place {
  double frame = 0;          ///< between the keys
  Limit limit = Limit::At;   ///< exchanged in a mirrored copy
  double copy = 0;           ///< number of offsets to add: negative before the keys
  bool is_reversed = false;  ///< time runs backwards in this copy
  bool is_held = false;      ///< after the last copy: the value is constant
};

/// The side that gives the value at a frame, or null if the keys give it. At an end key, a side
/// gives the limit from outside.
template <int D>
const Outside<D>* Extrapolated<D>::outside_of(double frame, Limit limit) const {
  if (frame < track.first() || (frame == track.first() && limit == Limit::Left)) return &before;
  if (frame > track.last() || (frame == track.last() && limit == Limit::Right)) return &after;
  return nullptr;
}

template <int D>
typename Extrapolated<D>::Place Extrapolated<D>::place_in_loop(const Outside<D>& side, double frame,
                                                               Limit limit) const {
  // The distance d from the end key, outwards: copy k is ((k-1) span, k span]; on a joint, only the
  // limit from farther out belongs to the next copy. fmod is exact, so joints are exact and phases
  // do not drift at any distance.
  const double first = track.first();
  const double last = track.last();
  const double span = last - first;
  const double distance = side.is_before ? first - frame : frame - last;
  const bool is_outward = limit == (side.is_before ? Limit::Left : Limit::Right);
  double phase = std::fmod(distance, span);
  const bool is_mirror = side.mode == Outside<D>::Mode::Mirror;
  bool is_odd = is_mirror && std::fmod(distance, 2 * span) < span;  // copy 1 is odd
  double copy = std::round((distance - phase) / span) + 1;
  if (phase == 0 && !is_outward) {
    phase = span;
    copy -= 1;
    is_odd = !is_odd;
  }

  Place place;
  place.limit = limit;
  if (copy > side.count) {
    // The value at the end of the last copy.
    copy = side.count;
    phase = span;
    is_odd = std::fmod(copy, 2) == 1;
    place.limit = Limit::At;
    place.is_held = true;
  }
  place.is_reversed = is_mirror && is_odd;
  if (place.is_reversed && place.limit != Limit::At) {
    place.limit = limit == Limit::Left ? Limit::Right : Limit::Left;
  }
  place.copy = side.is_before ? -copy : copy;
  const bool counts_from_first = side.is_before == place.is_reversed;
  if (phase == span) {
    place.frame = counts_from_first ? last : first;
  } else {
    place.frame = counts_from_first ? first + phase : last - phase;
  }
  return place;
}

template <int D>
template <class Locate>
Value<D> Extrapolated<D>::value(double frame, Limit limit, const Locate& locate) const {
  const Outside<D>* side = outside_of(frame, limit);
  Value<D> value;
  if (side == nullptr) {
    if (std::isnan(frame)) {  // the only frame without a value
      value.fill(frame);
      return value;
    }
    return track.value(frame, limit, locate(frame));
  }
  if (side->mode == Outside<D>::Mode::Line) {
    const double distance = frame - (side->is_before ? track.first() : track.last());
    for (int c = 0; c < D; ++c) {
      // A level line is level at infinity too.
      value[c] =
          side->slope[c] != 0 ? side->anchor[c] + side->slope[c] * distance : side->anchor[c];
    }
    return value;
  }
  const Place place = place_in_loop(*side, frame, limit);
  value = track.value(place.frame, place.limit, locate(place.frame));
  for (int c = 0; c < D; ++c) {
    if (side->offset[c] != 0) value[c] += place.copy * side->offset[c];
  }
  return value;
}

template <int D>
template <class Locate>
Value<D> Extrapolated<D>::velocity(double frame, Limit limit, const Locate& locate) const {
  const Outside<D>* side = outside_of(frame, limit);
  if (side == nullptr) {
    if (std::isnan(frame)) {
      Value<D> none;
      none.fill(frame);
      return none;
    }
    return track.velocity(frame, limit, locate(frame));
  }
  if (side->mode == Outside<D>::Mode::Line) return side->slope;
  const Place place = place_in_loop(*side, frame, limit);
  if (place.is_held) return {};
  Value<D> velocity = track.velocity(place.frame, place.limit, locate(place.frame));
  if (place.is_reversed) {
    for (double& each : velocity) each = 0 - each;  // no -0
  }
  return velocity;
}

}  // namespace pliant::timeline
