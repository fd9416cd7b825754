#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/timeline/cubic.hpp"
#include "pliant/timeline/key.hpp"

namespace pliant {

/// A smooth path through points in space, parametrised by arc length: an object that follows it
/// stays on it for any timing. An immutable value, safe to share between threads.
///
/// Between two waypoints it is a segment of the centripetal Catmull-Rom spline (docs/timeline.md,
/// eq. 24): it passes through every waypoint, is continuous in direction, and never has a loop or
/// cusp between two waypoints. Moving one waypoint changes only the four segments around it. An
/// open path starts and ends along its first and last chord.
class Path {
 public:
  static constexpr std::size_t least_waypoints = 3;
  static constexpr std::size_t most_waypoints = 100'000;

  /// Errors, naming the waypoint: fewer than three or more than 10^5; a number that is not finite
  /// or beyond 1e150; one in the same place as the one before, which for the first waypoint of a
  /// closed path is the last.
  [[nodiscard]] static Checked<Path> make(std::vector<Value<3>> waypoints, bool is_closed = false);

  /// The point after the share `progress` of the length: 0 is the first waypoint, 1 the last, or
  /// the first again on a closed path; clamped to [0, 1]. The share is accurate to 1e-12 [length].
  Value<3> at(double progress) const;

  double length() const { return length_; }  ///< > 0 [length]
  const std::vector<Value<3>>& waypoints() const { return waypoints_; }
  bool is_closed() const { return is_closed_; }

  /// The same waypoints, from which all else follows.
  friend bool operator==(const Path& a, const Path& b) {
    return a.waypoints_ == b.waypoints_ && a.is_closed_ == b.is_closed_;
  }

 private:
  /// Half of a segment between two waypoints, counted from one of them: q in [0, 1/2].
  using Half = std::array<timeline::Cubic, 3>;

  /// A part of a half so short that one quadrature gives the length of any part of it.
  struct Stretch {
    std::size_t half = 0;
    double from = 0;   ///< q at its start
    double to = 0.5;   ///< q at its end, which is less in the second half of a segment
    double start = 0;  ///< length of the path up to here [length]
  };

  Path() = default;
  void add_segment(std::size_t from, std::size_t to, const Value<3>& rate_from,
                   const Value<3>& rate_to);
  void measure(std::size_t half, double from, double to, int depth);
  double length_between(std::size_t half, double from, double to) const;
  double q_at(const Stretch& stretch, double walked, double whole) const;

  std::vector<Value<3>> waypoints_;
  bool is_closed_ = false;
  std::vector<Half> halves_;
  std::vector<Stretch> stretches_;
  double length_ = 0;
};

}  // namespace pliant
