#pragma once

#include <vector>

#include "pliant/timeline/key.hpp"

namespace pliant::timeline {

/// The input of automatic tangents: one component of the keys, and the straight lines between them.
struct KeyPolyline {
  std::vector<double> values;    ///< of the keys [unit]
  std::vector<double> arrivals;  ///< end values of the segments before the keys [unit]
  std::vector<bool> jumps;  ///< whether a key has a `left` that is used: open ends on both sides
  std::vector<double> lengths;  ///< of the segments [frames]
  std::vector<double> secants;  ///< slopes of the straight lines, to `arrivals` [unit/frame]
  std::vector<bool> is_bezier;  ///< of the segments
  bool is_periodic = false;     ///< the last segment continues in the first

  std::size_t size() const { return values.size(); }

  /// The straight lines that meet at a key, as used for one of its sides.
  struct Corner {
    bool has_before = false;
    bool has_after = false;
    double secant_before = 0;
    double secant_after = 0;
    double length_before = 0;
    double length_after = 0;

    bool is_open() const { return !(has_before && has_after); }
    bool is_extremum() const {
      return !is_open() &&
             !((secant_before > 0 && secant_after > 0) || (secant_before < 0 && secant_after < 0));
    }
    /// 3 min|s|, eq. 9: cubics with slopes up to this are monotone.
    double cap() const;
    /// The slope across both segments, eq. 7; at an open end the secant; without neighbours 0.
    double spline() const;
  };
  Corner at(std::size_t key, bool is_out) const;

  /// max - min of all key values and arrivals [unit].
  double range() const;
};

/// Whether a key has a `left` that is used: not after a step.
template <int D>
bool has_jump(const std::vector<Key<D>>& keys, std::size_t key) {
  if (!keys[key].left) return false;
  return key == 0 || keys[key - 1].next.kind != Interpolation::Kind::Step;
}

/// Component c of keys. Periodic if one side repeats with a smooth transition.
template <int D>
KeyPolyline key_polyline_of(const std::vector<Key<D>>& keys, const Extrapolation<D>& before,
                            const Extrapolation<D>& after, int c);

extern template KeyPolyline key_polyline_of(const std::vector<Key<1>>&, const Extrapolation<1>&,
                                            const Extrapolation<1>&, int);
extern template KeyPolyline key_polyline_of(const std::vector<Key<3>>&, const Extrapolation<3>&,
                                            const Extrapolation<3>&, int);

}  // namespace pliant::timeline
