#include "pliant/timeline/time_cubic.hpp"

#include <cmath>
#include <limits>

namespace pliant::timeline {

TimeCubic::TimeCubic(double start, double end, Pair start_rate, Pair end_rate) {
  // docs/timeline.md, eq. 4, with twice the digits: the error of x is then only that of the frame.
  const Pair length = exact_difference(end, start);
  const Pair rates = start_rate + end_rate;
  const Pair c3 = rates + -2.0 * length;
  const std::array<Pair, 2> c1 = {start_rate, end_rate};
  frames_ = {start, end};
  c3_ = c3.high;
  c3_low_ = c3.low;
  for (int side = 0; side < 2; ++side) {
    const Pair c2 = 3.0 * length + -1.0 * (rates + c1[side]);
    c1_[side] = c1[side].high;
    c1_low_[side] = c1[side].low;
    c2_[side] = c2.high;
    c2_low_[side] = c2.low;
  }
  // If floats cannot represent a guess, other methods are used.
  const bool is_usual = length.high > 1e-30 && length.high < 1e30;
  per_length_ =
      is_usual ? static_cast<float>(1 / length.high) : std::numeric_limits<float>::quiet_NaN();
  // An ulp of a frame is at least 2^-53 of it. One of the promised 4 is a reserve.
  const double least_frame = start < 0 && end > 0 ? 0 : std::fmin(std::fabs(start), std::fabs(end));
  has_small_frames_ = !(std::fmax(roundings(0), roundings(1)) <= 3 * least_frame);
  for (int piece = 0; piece < piece_count; ++piece) {
    // The second half is computed from the end.
    const double q = static_cast<double>(piece) / piece_count;
    const double elapsed = q <= 0.5 ? from_end(0).value(q) : length.high - from_end(1).value(1 - q);
    if (piece > 0) joints_[piece - 1] = elapsed;
    first_shares_[piece] = static_cast<float>(elapsed * per_length_);
    pieces_[piece] = piece_of(piece, length.high);
  }
}

double TimeCubic::roundings(int end) const {
  // All rounding errors in place_of without pairs, in multiples of 2^-53 at q = 1/2, where they are
  // largest: distance, coefficients, products, sums, and q itself.
  const Cubic x = from_end(end);
  const double q = 0.5;
  const double inner = q * q * std::fabs(x.c2 + q * x.c3);
  return 3 * x.value(q) + 2 * inner + 2 * q * q * q * std::fabs(x.c3) + q * q * std::fabs(x.c2) +
         q * x.c1 + q * x.slope(q);
}

TimeCubic::Piece TimeCubic::piece_of(int piece, double length) const {
  // The inverse through the start of the piece and `degree` more points, by divided differences.
  // The points are seven Chebyshev points, stretched so that the first is the start.
  constexpr int points = degree + 1;
  constexpr double width = 1.0 / piece_count;
  constexpr std::array<double, points> places = {0, 0.099, 0.277, 0.5, 0.723, 0.901, 1};
  const int end = piece / (piece_count / 2);
  const Cubic x = from_end(end);
  // In the second half q decreases from piece to piece.
  const double direction = end == 0 ? 1 : -1;
  const double first_q = end == 0 ? piece * width : 1 - piece * width;
  const double first_share = x.value(first_q) / length;
  std::array<double, points> shares;
  std::array<double, points> differences;
  for (int i = 0; i < points; ++i) {
    differences[i] = direction * places[i] * width;
    shares[i] = direction * (x.value(first_q + differences[i]) / length - first_share);
  }
  for (int order = 1; order < points; ++order) {
    for (int i = points - 1; i >= order; --i) {
      differences[i] = (differences[i] - differences[i - 1]) / (shares[i] - shares[i - order]);
    }
  }
  std::array<double, points> c = {differences[degree]};
  for (int i = degree - 1; i >= 0; --i) {
    for (int power = degree; power > 0; --power) c[power] = c[power - 1] - shares[i] * c[power];
    c[0] = differences[i] - shares[i] * c[0];
  }
  Piece result;
  for (int power = 1; power < points; ++power) {
    // Near a vertical tangent there is no such polynomial; place_of treats NaN as no guess.
    const bool is_sound = std::fabs(c[power]) < 1e30;
    result[power - 1] =
        is_sound ? static_cast<float>(c[power]) : std::numeric_limits<float>::quiet_NaN();
  }
  return result;
}

double TimeCubic::residual(int end, double q, Pair distance) const {
  // Compensated Horner scheme (Graillat, Langlois, Louvet): as if computed with twice the digits.
  const Pair q_halves = halves(q);
  const Pair p3 = exact_product(c3_, halves(c3_), q, q_halves);
  const Pair s2 = exact_sum(p3.high, c2_[end]);
  double low = p3.low + s2.low + c2_low_[end] + c3_low_ * q;
  const Pair p2 = exact_product(s2.high, halves(s2.high), q, q_halves);
  const Pair s1 = exact_sum(p2.high, c1_[end]);
  low = low * q + (p2.low + s1.low + c1_low_[end]);
  const Pair p1 = exact_product(s1.high, halves(s1.high), q, q_halves);
  low = low * q + p1.low;
  return (p1.high - distance.high) + (low - distance.low);
}

TimeCubic::Place TimeCubic::careful_place_of(double frame) const {
  const Guess guess = guess_of(frame);
  const int side = guess.end;
  const Pair distance =
      side == 0 ? exact_difference(frame, frames_[side]) : exact_difference(frames_[side], frame);
  if (!(distance.high > 0)) return {side, 0, 0};

  const Cubic x = from_end(side);
  double q = guess.q;
  bool is_close = has_small_frames_;
  if (!is_close || !(q > 0 && q <= largest_place)) {
    // If the guess failed: the parabola that equals x at 0 (with its slope) and at 1/2. It follows
    // the square root at a handle of length 0, where Newton from afar would be slow.
    const double chord = x.c2 + x.c3 / 2;
    const double discriminant = x.c1 * x.c1 + 4 * chord * distance.high;
    q = 2 * distance.high / (x.c1 + std::sqrt(discriminant));
    is_close = false;
  }

  for (int round = 0; round < 6; ++round) {
    if (!(q > 0 && q <= largest_place)) break;
    if (!is_close) {
      // One division, then the series of the inverse cubic (eq. 5): fourth order.
      const double inverse = 1 / x.slope(q);
      const double newton = (distance.high - q * (x.c1 + q * (x.c2 + q * x.c3))) * inverse;
      const double bend = x.half_curvature(q) * inverse * newton;
      const double twist = x.c3 * inverse * newton * newton;
      if (std::fabs(bend) < 0.25 && std::fabs(twist) < 0.25) {
        q += newton * (1 - bend + (2 * bend * bend - twist));
      } else {
        q += newton / (1 + bend);  // Halley: of lower order, but reliable far from the root
        continue;
      }
      // The remaining error is about 5 bend³ of the step; the order of the last step makes it
      // negligible.
      is_close = bend * bend <= 1e-3 && std::fabs(twist) <= 1e-3;
      if (!is_close || !(q > 0 && q <= largest_place)) continue;
    }
    const Step last = step_from(q, x, -residual(side, q, distance));
    if (last.is_last) {
      const Pair place = exact_sum(q, last.length);
      return {side, place.high, place.low};
    }
    q += last.length;
    is_close = false;
  }
  return search(side, distance);
}

TimeCubic::Place TimeCubic::search(int side, Pair distance) const {
  // Near a vertical tangent. The bracket only shrinks: a Newton step inside it, as long as that at
  // least halves the bracket every second time, otherwise bisection.
  const Cubic x = from_end(side);
  // A quarter of an ulp of the distance is below the precision of the frame itself.
  const double enough = std::numeric_limits<double>::epsilon() / 8 * distance.high;
  double low = 0;
  double high = largest_place;
  double q = 0.25;
  double width_before = high;
  for (int round = 0; round < 1200; ++round) {  // bisection alone needs at most 1100 (subnormal q)
    const double miss = residual(side, q, distance);
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
  // The part of the root that q cannot represent, unless the tangent is too steep to compute it.
  const double correction = -residual(side, q, distance) / x.slope(q);
  const bool is_rounding = std::fabs(correction) <= std::numeric_limits<double>::epsilon() * q;
  return {side, q, is_rounding ? correction : 0};
}

}  // namespace pliant::timeline
