#include "pliant/timeline/key_polyline.hpp"

#include <algorithm>
#include <cmath>

namespace pliant::timeline {

double KeyPolyline::Corner::cap() const {
  const double before = std::fabs(secant_before);
  const double after = std::fabs(secant_after);
  if (!has_before) return 3 * after;
  if (!has_after) return 3 * before;
  return 3 * std::min(before, after);
}

double KeyPolyline::Corner::spline() const {
  if (!has_before) return has_after ? secant_after : 0;
  if (!has_after) return secant_before;
  // (v_n - v_p)/(t_n - t_p) as a mean of the secants, so that it works across a seam too.
  const double share_after = length_after / (length_before + length_after);
  return secant_before + (secant_after - secant_before) * share_after;
}

KeyPolyline::Corner KeyPolyline::at(std::size_t key, bool is_out) const {
  Corner corner;
  const std::size_t segments = secants.size();
  if (segments == 0) return corner;
  const bool is_first = key == 0;
  const bool is_last = key == segments;
  const std::size_t before = is_first ? segments - 1 : key - 1;
  const std::size_t after = is_last ? 0 : key;
  corner.has_before = !is_first || is_periodic;
  corner.has_after = !is_last || is_periodic;
  // A jump separates its two sides; the outer side of an end key uses the segment of its other
  // side.
  if (jumps[key] && corner.has_before && corner.has_after) {
    (is_out ? corner.has_before : corner.has_after) = false;
  }
  if (corner.has_before) {
    corner.secant_before = secants[before];
    corner.length_before = lengths[before];
  }
  if (corner.has_after) {
    corner.secant_after = secants[after];
    corner.length_after = lengths[after];
  }
  return corner;
}

double KeyPolyline::range() const {
  double low = values.front();
  double high = low;
  for (std::size_t k = 0; k < values.size(); ++k) {
    low = std::min({low, values[k], arrivals[k]});
    high = std::max({high, values[k], arrivals[k]});
  }
  return high - low;
}

template <int D>
KeyPolyline key_polyline_of(const std::vector<Key<D>>& keys, const Extrapolation<D>& before,
                            const Extrapolation<D>& after, int c) {
  KeyPolyline polyline;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const bool jumps = has_jump(keys, k);
    polyline.values.push_back(keys[k].value[c]);
    polyline.arrivals.push_back(jumps ? (*keys[k].left)[c] : keys[k].value[c]);
    polyline.jumps.push_back(jumps);
    if (k == 0) continue;
    polyline.lengths.push_back(keys[k].frame - keys[k - 1].frame);
    polyline.secants.push_back((polyline.arrivals[k] - polyline.values[k - 1]) /
                               polyline.lengths.back());
    polyline.is_bezier.push_back(keys[k - 1].next.kind == Interpolation::Kind::Bezier);
  }
  using Kind = typename Extrapolation<D>::Kind;
  const auto is_kind = [&](Kind kind) { return before.kind == kind || after.kind == kind; };
  const bool closes = polyline.values.front() == polyline.values.back();
  // A jump at the seam makes both its sides open ends, for every kind of repetition.
  polyline.is_periodic = keys.size() > 1 && !polyline.jumps.front() && !polyline.jumps.back() &&
                         (is_kind(Kind::RepeatOffset) || (is_kind(Kind::Repeat) && closes));
  return polyline;
}

template KeyPolyline key_polyline_of(const std::vector<Key<1>>&, const Extrapolation<1>&,
                                     const Extrapolation<1>&, int);
template KeyPolyline key_polyline_of(const std::vector<Key<3>>&, const Extrapolation<3>&,
                                     const Extrapolation<3>&, int);

}  // namespace pliant::timeline
