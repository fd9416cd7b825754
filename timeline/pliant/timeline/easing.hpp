#pragma once

#include <array>

#include "pliant/timeline/key.hpp"

namespace pliant::timeline {

/// A position in a segment, measured from both ends: passed + left = 1, each with full precision.
struct Progress {
  double passed = 0;
  double left = 1;
};

/// One easing of a segment, ready to evaluate: the part of the change of value that is done at a
/// time, and its slope (docs/timeline.md, eq. 14 to 23).
class Easing {
 public:
  /// Requires: length > 0; `change` is the segment's change of value (an elastic's amplitude is
  /// relative to it); is_sound(interpolation, length).
  Easing(const Interpolation& interpolation, double length, double change);

  /// Whether the numbers of an elastic stay finite: its segment contains at most 1e15 periods.
  static bool is_sound(const Interpolation& interpolation, double length);

  /// Part of the change [1], counted from the nearer end: the part done if `is_from_start`, else
  /// the part still to do.
  struct Share {
    double amount = 0;
    bool is_from_start = true;
  };
  Share share(Progress at) const;

  /// Whether the easing depends on the change of a component.
  bool is_elastic() const { return ease_ == Ease::Elastic; }

  /// scale * d(share)/d(passed) [1]; infinite at the steep end of circ. For an elastic whose
  /// amplitude is large relative to its change, the scale must be the change, or the result
  /// overflows.
  double slope(Progress at, double scale = 1) const;

  /// Whether the slope is infinite itself, not by overflow.
  bool is_upright(Progress at) const;

  /// The places in (0, 1) where the share may have an extremum that bounds the share in [from, to],
  /// and their number. The waves of an elastic shrink, so its largest ones suffice.
  struct Places {
    std::array<double, 12> passed = {};
    int count = 0;
    void add(double place) {
      if (count < static_cast<int>(passed.size())) passed[count++] = place;
    }
  };
  Places extrema(double from, double to) const;

 private:
  double ease_in(Progress at) const;
  double ease_in_slope(Progress at, double scale) const;
  double elastic(Progress at) const;
  double elastic_slope(Progress at, double scale = 1) const;
  void add_extrema_of_ease_in(double from, double to, Places& places) const;
  void add_extrema_of_elastic(double from, double to, Places& places) const;

  Ease ease_;
  EaseSide side_;
  double overshoot_ = 0;         // back: q
  double length_ = 0;            // elastic: of the whole segment [frames]
  double period_ = 0;            // elastic [frames]
  double amplitude_ = 1;         // elastic: A'
  double shift_ = 0;             // elastic: s, in periods
  double full_within_ = 0;       // elastic with A < 1: |s| [frames], otherwise 0
  double damped_amplitude_ = 1;  // elastic with A < 1: A
};

}  // namespace pliant::timeline
