#include "pliant/timeline/tangents.hpp"

#include <algorithm>
#include <cmath>

#include "pliant/timeline/key_polyline.hpp"

namespace pliant::timeline {

namespace {

/// Eq. 8: a mean of the two secants whose weight follows the nearer key. Source: Maya's auto-ease.
double auto_ease(const KeyPolyline::Corner& corner) {
  const double f = corner.length_before / (corner.length_before + corner.length_after);
  const double centred = f - 0.5;
  const double g = 0.5 + centred * (1.5 - 2 * centred * centred);
  return (1 - g) * corner.secant_before + g * corner.secant_after;
}

double capped(double slope, double cap) { return std::clamp(slope, -cap, cap); }

template <int D>
class Side {
 public:
  Side(const std::vector<Key<D>>& keys, const KeyPolyline& polyline, double flat_below, int c)
      : keys_(keys), course_(polyline), flat_below_(flat_below), c_(c) {}

  double slope(std::size_t key, bool is_out, bool extends_line) const {
    using Kind = typename Tangent<D>::Kind;
    const Tangent<D>& tangent = is_out ? keys_[key].out : keys_[key].in;
    const KeyPolyline::Corner corner = course_.at(key, is_out);
    switch (tangent.kind) {
      case Kind::Auto:
        if (corner.is_open()) return extends_line ? corner.spline() : 0;
        return corner.is_extremum() ? 0 : capped(auto_ease(corner), corner.cap());
      case Kind::Plateau:
        if (corner.is_open()) return extends_line ? corner.spline() : 0;
        return corner.is_extremum() ? 0 : capped(corner.spline(), corner.cap());
      case Kind::Spline:
        return corner.spline();
      case Kind::Clamped:
        return is_level(key, is_out) ? 0 : corner.spline();
      case Kind::Linear:
        if (is_out) return corner.has_after ? corner.secant_after : corner.secant_before;
        return corner.has_before ? corner.secant_before : corner.secant_after;
      case Kind::Flat:
        return 0;
      case Kind::Slope:
        return tangent.slope[c_];
      case Kind::Handle:
        return handle_slope(tangent, is_out);
      case Kind::Smooth:
      case Kind::Free:
        return 0;  // solved together, see smooth_tangents.hpp
    }
    return 0;
  }

 private:
  double handle_slope(const Tangent<D>& tangent, bool is_out) const {
    const bool points_forward = is_out ? tangent.handle_frames > 0 : tangent.handle_frames < 0;
    return points_forward ? tangent.handle_value[c_] / tangent.handle_frames : 0;
  }

  /// Whether the span on this side of a key hardly changes its value (eq. 10). The outer side of an
  /// end key uses the span of the inner side.
  bool is_level(std::size_t key, bool is_out) const {
    const std::size_t segments = course_.secants.size();
    if (segments == 0) return true;
    std::size_t span = is_out ? key : key - 1;
    if (is_out && key == segments) span = course_.is_periodic ? 0 : segments - 1;
    if (!is_out && key == 0) span = course_.is_periodic ? segments - 1 : 0;
    return std::fabs(course_.arrivals[span + 1] - course_.values[span]) <= flat_below_;
  }

  const std::vector<Key<D>>& keys_;
  const KeyPolyline& course_;
  double flat_below_;
  int c_;
};

template <int D>
bool extends_line(const Extrapolation<D>& outside) {
  using Kind = typename Extrapolation<D>::Kind;
  return outside.kind == Kind::Linear || outside.kind == Kind::LinearOuter;
}

template <int D>
SmoothKind smooth_kind(const Tangent<D>& tangent) {
  using Kind = typename Tangent<D>::Kind;
  if (tangent.kind == Kind::Smooth) return SmoothKind::Capped;
  return tangent.kind == Kind::Free ? SmoothKind::Free : SmoothKind::None;
}

}  // namespace

template <int D>
Slopes tangent_slopes(const std::vector<Key<D>>& keys, const Extrapolation<D>& before,
                      const Extrapolation<D>& after, int c, const StopRequest& should_stop) {
  const KeyPolyline polyline = key_polyline_of(keys, before, after, c);
  const Side<D> side(keys, polyline, 1e-3 * polyline.range(), c);
  Slopes slopes;
  SmoothSides smooth;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const bool is_line =
        (k == 0 && extends_line(before)) || (k + 1 == keys.size() && extends_line(after));
    slopes.in.push_back(side.slope(k, false, is_line));
    slopes.out.push_back(side.slope(k, true, is_line));
    smooth.in.push_back(smooth_kind(keys[k].in));
    smooth.out.push_back(smooth_kind(keys[k].out));
  }
  solve_smooth_tangents(polyline, smooth, slopes, should_stop);
  return slopes;
}

template Slopes tangent_slopes(const std::vector<Key<1>>&, const Extrapolation<1>&,
                               const Extrapolation<1>&, int, const StopRequest&);
template Slopes tangent_slopes(const std::vector<Key<3>>&, const Extrapolation<3>&,
                               const Extrapolation<3>&, int, const StopRequest&);

}  // namespace pliant::timeline
