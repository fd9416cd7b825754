#pragma once

#include <cstddef>

#include "pliant/timeline/key.hpp"
#include "pliant/timeline/track.hpp"

namespace pliant::timeline {

/// The behaviour of a curve beyond one of its end keys, compiled.
template <int D>
struct Outside {
  enum class Mode { Line, Repeat, Mirror };
  Mode mode = Mode::Line;
  bool is_before = false;
  Value<D> anchor = {};  ///< Line: the value it starts from [unit]
  Value<D> slope = {};   ///< Line: [unit/frame]
  Value<D> offset = {};  ///< Repeat: how much each copy is raised over the one before [unit]
  double count = 0;      ///< loops: number of copies, infinite if endless
};

/// A track with both its sides: a value at every finite frame (docs/timeline.md, section "Outside
/// the keys"). `locate` returns the segment of a frame between the keys, by a search, or by a guess
/// that is checked first.
template <int D>
struct Extrapolated {
  Track<D> track;
  Outside<D> before;
  Outside<D> after;

  template <class Locate>
  Value<D> value(double frame, Limit limit, const Locate& locate) const;

  /// Limit: Left or Right.
  template <class Locate>
  Value<D> velocity(double frame, Limit limit, const Locate& locate) const;

  /// The range of all values in [from, to], including the one-sided limits inside.
  Bounds<D> bounds(double from, double to) const;

 private:
  struct Place;
  const Outside<D>* outside_of(double frame, Limit limit) const;
  Place place_in_loop(const Outside<D>& side, double frame, Limit limit) const;
  void add_bounds_outside(const Outside<D>& side, double from, double to, Bounds<D>& bounds) const;
};

}  // namespace pliant::timeline
