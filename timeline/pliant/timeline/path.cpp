#include "pliant/timeline/path.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pliant/timeline/checks.hpp"
#include "pliant/timeline/number_text.hpp"
#include "pliant/timeline/segment.hpp"

namespace pliant {
namespace {

// Gauss-Legendre quadrature with twelve nodes: the positive ones and their weights on [-1, 1].
constexpr std::array<std::array<double, 2>, 6> nodes = {{
    {0.1252334085114689155, 0.2491470458134027850},
    {0.3678314989981801938, 0.2334925365383548088},
    {0.5873179542866174473, 0.2031674267230659217},
    {0.7699026741943046870, 0.1600783285433462263},
    {0.9041172563704748567, 0.1069393259953184310},
    {0.9815606342467192507, 0.0471753363865118272},
}};

// Relative to the length of the part that is cut in two: well below the required accuracy of a
// share of the length.
constexpr double quadrature_tolerance = 1e-13;

// The most times that a stretch is halved: around a place where the speed is 0, each halving
// divides its length by four.
constexpr int deepest = 24;

double distance(const Value<3>& a, const Value<3>& b) {
  const double x = b[0] - a[0], y = b[1] - a[1], z = b[2] - a[2];
  return std::sqrt(x * x + y * y + z * z);
}

double speed(const std::array<timeline::Cubic, 3>& half, double q) {
  const double x = half[0].slope(q), y = half[1].slope(q), z = half[2].slope(q);
  return std::sqrt(x * x + y * y + z * z);
}

// docs/timeline.md, eq. (24): the derivative at a waypoint for the knots h = sqrt(distance), from
// the secants on both sides, each weighted with the knot span of the other.
Value<3> rate_at(const Value<3>& before, const Value<3>& here, const Value<3>& after) {
  const double h0 = std::sqrt(distance(before, here)), h1 = std::sqrt(distance(here, after));
  Value<3> rate;
  for (std::size_t c = 0; c < 3; ++c) {
    const double s0 = (here[c] - before[c]) / h0, s1 = (after[c] - here[c]) / h1;
    rate[c] = (s0 * h1 + s1 * h0) / (h0 + h1);
  }
  return rate;
}

// At the end of an open path the derivative is along the chord.
Value<3> chord_rate(const Value<3>& from, const Value<3>& to) {
  const double h = std::sqrt(distance(from, to));
  return {(to[0] - from[0]) / h, (to[1] - from[1]) / h, (to[2] - from[2]) / h};
}

std::optional<Complaint> broken_rule(const std::vector<Value<3>>& waypoints, bool is_closed) {
  if (waypoints.size() < Path::least_waypoints) {
    return Complaint{waypoints.size(), "a path must have at least three waypoints"};
  }
  if (waypoints.size() > Path::most_waypoints) {
    return Complaint{waypoints.size(), "a path must have at most 100000 waypoints"};
  }
  for (std::size_t k = 0; k < waypoints.size(); ++k) {
    for (const double x : waypoints[k]) {
      if (!(std::abs(x) <= timeline::largest_number)) {
        return Complaint{k, "has the coordinate " + timeline::number_text(x) +
                                ", which is not finite or beyond 1e150"};
      }
    }
    if (k == 0 && !is_closed) continue;
    const Value<3>& before = waypoints[k == 0 ? waypoints.size() - 1 : k - 1];
    if (!(distance(before, waypoints[k]) > 0)) {
      return Complaint{
          k, k == 0
                 ? "is at the same position as the last one, from which a closed path returns to it"
                 : "is at the same position as the one before"};
    }
  }
  return {};
}

}  // namespace

Checked<Path> Path::make(std::vector<Value<3>> waypoints, bool is_closed) {
  if (auto broken = broken_rule(waypoints, is_closed)) return tl::unexpected(*std::move(broken));
  const std::size_t count = waypoints.size();
  std::vector<Value<3>> rates(count);
  for (std::size_t k = 0; k < count; ++k) {
    const Value<3>& before = waypoints[(k + count - 1) % count];
    const Value<3>& after = waypoints[(k + 1) % count];
    if (k == 0 && !is_closed) {
      rates[k] = chord_rate(waypoints[k], after);
    } else if (k + 1 == count && !is_closed) {
      rates[k] = chord_rate(before, waypoints[k]);
    } else {
      rates[k] = rate_at(before, waypoints[k], after);
    }
  }
  Path path;
  path.waypoints_ = std::move(waypoints);
  path.is_closed_ = is_closed;
  for (std::size_t k = 0; k + (is_closed ? 0 : 1) < count; ++k) {
    path.add_segment(k, (k + 1) % count, rates[k], rates[(k + 1) % count]);
  }
  return path;
}

// Adds the two halves of a segment and measures them.
void Path::add_segment(std::size_t from, std::size_t to, const Value<3>& rate_from,
                       const Value<3>& rate_to) {
  const double span = std::sqrt(distance(waypoints_[from], waypoints_[to]));
  Value<3> start_rate, end_rate;
  for (std::size_t c = 0; c < 3; ++c) {
    start_rate[c] = span * rate_from[c];
    end_rate[c] = span * rate_to[c];
  }
  const auto ends =
      timeline::value_cubics<3>(waypoints_[from], waypoints_[to], start_rate, end_rate);
  const std::size_t first = halves_.size();
  halves_.push_back(ends[0]);
  halves_.push_back(ends[1]);
  measure(first, 0, 0.5, 0);
  measure(first + 1, 0.5, 0, 0);
}

// Divides a part of a half into stretches for each of which one quadrature is accurate.
void Path::measure(std::size_t half, double from, double to, int depth) {
  const double middle = 0.5 * (from + to);
  const double whole = length_between(half, from, to);
  const double parts = length_between(half, from, middle) + length_between(half, middle, to);
  if (depth == deepest || std::abs(whole - parts) <= quadrature_tolerance * parts) {
    stretches_.push_back({half, from, to, length_});
    length_ += parts;
    return;
  }
  measure(half, from, middle, depth + 1);
  measure(half, middle, to, depth + 1);
}

double Path::length_between(std::size_t half, double from, double to) const {
  const double centre = 0.5 * (from + to), reach = 0.5 * (to - from);
  double sum = 0;
  for (const auto& [node, weight] : nodes) {
    sum += weight * (speed(halves_[half], centre - reach * node) +
                     speed(halves_[half], centre + reach * node));
  }
  return std::abs(reach) * sum;
}

// Newton's method for the q at which a length of `walked`, of a stretch's `whole` length, is
// passed. The root is kept in a bracket, which is halved if a step would leave it.
double Path::q_at(const Stretch& stretch, double walked, double whole) const {
  double behind = stretch.from, ahead = stretch.to;
  double q = stretch.from + (stretch.to - stretch.from) * (walked / whole);
  const double way = stretch.to > stretch.from ? 1 : -1;
  for (int step = 0; step < 64; ++step) {
    const double excess = length_between(stretch.half, stretch.from, q) - walked;
    if (std::abs(excess) <= 1e-15 * whole) break;
    (excess > 0 ? ahead : behind) = q;
    const double next = q - way * excess / speed(halves_[stretch.half], q);
    const bool is_inside = way * (next - behind) > 0 && way * (ahead - next) > 0;
    const double refined = is_inside ? next : 0.5 * (behind + ahead);
    if (refined == q) break;
    q = refined;
  }
  return q;
}

Value<3> Path::at(double progress) const {
  const double walked = progress > 0 ? std::min(progress, 1.0) * length_ : 0;
  const auto after =
      std::upper_bound(stretches_.begin(), stretches_.end(), walked,
                       [](double way, const Stretch& stretch) { return way < stretch.start; });
  const Stretch& stretch = *(after - 1);  // exists, as the first one starts at 0
  const double end = after == stretches_.end() ? length_ : after->start;
  const double whole = end - stretch.start;
  const double rest = walked - stretch.start;
  const double q = rest < whole ? q_at(stretch, rest, whole) : stretch.to;
  Value<3> place;
  for (std::size_t c = 0; c < 3; ++c) place[c] = halves_[stretch.half][c].value(q);
  return place;
}

}  // namespace pliant
