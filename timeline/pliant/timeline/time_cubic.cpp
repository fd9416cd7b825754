#include "pliant/timeline/time_cubic.hpp"

#include <cmath>
#include <limits>

namespace pliant::timeline {

namespace {

// The middle of a segment belongs to either end; rounding may put the root a little beyond 1/2.
constexpr double largest_place = 0.5 + 0x1p-10;

}  // namespace

TimeCubic::TimeCubic(Pair length, Pair start_rate, Pair end_rate) {
  // docs/timeline.md, eq. 4, in twice the digits: the error of x is then that of the frame alone.
  const Pair rates = start_rate + end_rate;
  c3_ = rates + -2.0 * length;
  ends_[0].c1 = start_rate;
  ends_[0].c2 = 3.0 * length + -1.0 * (rates + start_rate);
  ends_[1].c1 = end_rate;
  ends_[1].c2 = 3.0 * length + -1.0 * (rates + end_rate);
  for (End& end : ends_) end.chord = end.c2.high + c3_.high / 2;
  middle_ = from_end(0).value(0.5);
}

double TimeCubic::residual(const End& end, double q, Pair distance) const {
  // Compensated Horner scheme (Graillat, Langlois, Louvet): as if computed with twice the digits.
  const Pair q_halves = halves(q);
  const Pair p3 = exact_product(c3_.high, halves(c3_.high), q, q_halves);
  const Pair s2 = exact_sum(p3.high, end.c2.high);
  double low = p3.low + s2.low + end.c2.low + c3_.low * q;
  const Pair p2 = exact_product(s2.high, halves(s2.high), q, q_halves);
  const Pair s1 = exact_sum(p2.high, end.c1.high);
  low = low * q + (p2.low + s1.low + end.c1.low);
  const Pair p1 = exact_product(s1.high, halves(s1.high), q, q_halves);
  low = low * q + p1.low;
  return (p1.high - distance.high) + (low - distance.low);
}

TimeCubic::Place TimeCubic::place_of(double frame, double start, double end) const {
  const double elapsed = frame - start;
  const int side = elapsed <= middle_ ? 0 : 1;
  const Pair distance = side == 0 ? exact_difference(frame, start) : exact_difference(end, frame);
  if (!(distance.high > 0)) return {side, 0, 0};

  const End& near = ends_[side];
  const Cubic x = from_end(side);
  // First guess: the parabola that meets x at 0 (with its slope) and at 1/2. It follows the square
  // root at a handle of length 0, where Newton from afar would crawl.
  const double discriminant = x.c1 * x.c1 + 4 * near.chord * distance.high;
  double q = 2 * distance.high / (x.c1 + std::sqrt(discriminant));

  for (int round = 0; round < 6; ++round) {
    if (!(q > 0 && q <= largest_place)) break;
    // One division, then the series of the inverse cubic (eq. 5): fourth order.
    const double inverse = 1 / x.slope(q);
    const double newton = (distance.high - q * (x.c1 + q * (x.c2 + q * x.c3))) * inverse;
    const double bend = x.half_curvature(q) * inverse * newton;
    const double twist = x.c3 * inverse * newton * newton;
    if (std::fabs(bend) < 0.25 && std::fabs(twist) < 0.25) {
      q += newton * (1 - bend + (2 * bend * bend - twist));
    } else {
      q += newton / (1 + bend);  // Halley: of lower order, but sound far from the root
      continue;
    }
    // What is left of the error is about 5 bend³ of the step; the last step's own order does the
    // rest.
    if (bend * bend > 1e-3 || std::fabs(twist) > 1e-3) continue;

    if (!(q > 0 && q <= largest_place)) break;
    const double last_inverse = 1 / x.slope(q);
    const double last_newton = -residual(near, q, distance) * last_inverse;
    const double last_bend = x.half_curvature(q) * last_inverse * last_newton;
    const double last_twist = x.c3 * last_inverse * last_newton * last_newton;
    const double correction =
        last_newton * (1 - last_bend + (2 * last_bend * last_bend - last_twist));
    const double left_over = (std::fabs(last_bend) + std::fabs(last_twist)) *
                             (last_bend * last_bend + std::fabs(last_twist)) * last_newton;
    if (5 * std::fabs(left_over) <= 0x1p-56 * q) {
      const Pair place = exact_sum(q, correction);
      return {side, place.high, place.low};
    }
    q += correction;
  }
  return search(side, distance);
}

TimeCubic::Place TimeCubic::search(int side, Pair distance) const {
  // Beside a vertical tangent. The bracket only ever shrinks: a Newton step inside it while that at
  // least halves the bracket every second time, otherwise bisection.
  const End& near = ends_[side];
  const Cubic x = from_end(side);
  // A quarter of an ulp of the distance is below what the frame itself can tell.
  const double enough = std::numeric_limits<double>::epsilon() / 8 * distance.high;
  double low = 0;
  double high = largest_place;
  double q = 0.25;
  double width_before = high;
  for (int round = 0; round < 1200; ++round) {  // bisection alone ends within 1100 (subnormal q)
    const double miss = residual(near, q, distance);
    if (std::fabs(miss) <= enough) break;
    (miss > 0 ? high : low) = q;
    const double width = high - low;
    if (width <= std::numeric_limits<double>::epsilon() / 2 * high) break;
    double next = q - miss / x.slope(q);
    const bool is_slow = round % 2 == 1 && width > width_before / 2;
    if (round % 2 == 1) width_before = width;
    if (is_slow || !(next > low && next < high)) next = low + width / 2;
    if (next == q) break;
    q = next;
  }
  // What q cannot hold of the root, unless the tangent is too steep to tell.
  const double correction = -residual(near, q, distance) / x.slope(q);
  const bool is_rounding = std::fabs(correction) <= std::numeric_limits<double>::epsilon() * q;
  return {side, q, is_rounding ? correction : 0};
}

}  // namespace pliant::timeline
