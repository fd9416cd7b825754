#include "pliant/timeline/extrapolated.hpp"

#include <algorithm>
#include <cmath>

#include "pliant/timeline/extrapolated_evaluation.hpp"

namespace pliant::timeline {

template <int D>
Bounds<D> Extrapolated<D>::bounds(double from, double to) const {
  if (to < from) std::swap(from, to);
  const auto locate = [this](double frame) { return track.segment_at(frame); };
  const Value<D> start = value(from, Limit::At, locate);
  Bounds<D> bounds{start, start};
  bounds.add(value(to, Limit::At, locate));
  if (from < track.first()) {
    add_bounds_outside(before, from, std::min(to, track.first()), bounds);
  }
  if (to > track.last()) add_bounds_outside(after, std::max(from, track.last()), to, bounds);
  const double inner_from = std::max(from, track.first());
  const double inner_to = std::min(to, track.last());
  if (inner_from <= inner_to) track.add_bounds({inner_from, inner_to}, bounds);
  return bounds;
}

template <int D>
void Extrapolated<D>::add_bounds_outside(const Outside<D>& side, double from, double to,
                                         Bounds<D>& bounds) const {
  const auto locate = [this](double frame) { return track.segment_at(frame); };
  const double end_key = side.is_before ? track.first() : track.last();
  const double near = side.is_before ? to : from;
  const double far = side.is_before ? from : to;
  if (side.mode == Outside<D>::Mode::Line) {
    const Limit outward = side.is_before ? Limit::Left : Limit::Right;
    bounds.add(value(near, outward, locate));
    bounds.add(value(far, Limit::At, locate));
    return;
  }

  const double first = track.first();
  const double last = track.last();
  const double span = last - first;
  // From phase `near_phase` of copy `nearest` to phase `far_phase` of copy `farthest`, outwards.
  const double near_distance = std::fabs(near - end_key);
  const double near_phase = std::fmod(near_distance, span);
  const double nearest = std::round((near_distance - near_phase) / span) + 1;
  const double far_distance = std::fabs(far - end_key);
  double far_phase = std::fmod(far_distance, span);
  double farthest = std::round((far_distance - far_phase) / span) + 1;
  if (far_phase == 0) {
    far_phase = span;
    farthest -= 1;
  }
  if (farthest > side.count) {
    bounds.add(value(far, Limit::At, locate));  // the constant value after the last copy
    farthest = side.count;
    far_phase = span;
  }
  if (nearest > farthest) return;

  const auto add_copy = [&](double copy, double phase_from, double phase_to) {
    const bool is_reversed = side.mode == Outside<D>::Mode::Mirror && std::fmod(copy, 2) == 1;
    const bool counts_from_first = side.is_before == is_reversed;
    typename Track<D>::Interval part;
    // The joint nearer to the keys belongs to the copy nearer to them.
    if (counts_from_first) {
      part = {first + phase_from, phase_to == span ? last : first + phase_to, phase_from > 0, true};
    } else {
      part = {phase_to == span ? first : last - phase_to, last - phase_from, true, phase_from > 0};
    }
    part.from = std::clamp(part.from, first, last);
    part.to = std::clamp(part.to, part.from, last);
    const Value<D> some = track.value(part.from, Limit::Right, track.segment_at(part.from));
    Bounds<D> of_part{some, some};
    track.add_bounds(part, of_part);
    const double raised = side.is_before ? -copy : copy;
    for (int c = 0; c < D; ++c) {
      if (side.offset[c] == 0) continue;
      of_part.low[c] += raised * side.offset[c];
      of_part.high[c] += raised * side.offset[c];
    }
    bounds.add(of_part.low);
    bounds.add(of_part.high);
  };

  if (nearest == farthest) {
    add_copy(nearest, near_phase, far_phase);
    return;
  }
  add_copy(nearest, near_phase, span);
  add_copy(farthest, 0, far_phase);
  // Whole copies differ only by their offset, so the outermost ones bound the others.
  if (farthest - nearest >= 2) {
    add_copy(nearest + 1, 0, span);
    add_copy(farthest - 1, 0, span);
  }
}

template struct Extrapolated<1>;
template struct Extrapolated<3>;

}  // namespace pliant::timeline
