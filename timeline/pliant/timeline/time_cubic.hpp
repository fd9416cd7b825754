#pragma once

#include <array>
#include <cmath>

#include "pliant/timeline/cubic.hpp"
#include "pliant/timeline/exact_sum.hpp"

namespace pliant::timeline {

/// The time of a Bézier segment as a function of its parameter, and the inverse: x(u) = t solved
/// for u (docs/timeline.md, eq. 3 and section "The time solve").
///
/// The unknown is q, the parameter counted from the nearer end, and the equation is in frames from
/// that end, so that a frame next to a key loses no precision.
class alignas(64) TimeCubic {
 public:
  /// A parameter q + correction, in [0, 1/2] except for rounding, from `end` (0: start, 1: end).
  /// The correction is the rounding error of q.
  struct Place {
    int end = 0;
    double q = 0;
    double correction = 0;
  };

  /// The cubic with x(0) = start, x(1) = end, x'(0) = start_rate, x'(1) = end_rate [frames].
  /// Requires: start < end; rates >= 0 for which x does not decrease (eq. 6).
  TimeCubic(double start, double end, Pair start_rate, Pair end_rate);

  /// The place of a frame. Its x is within 3 ulp of the frame; near frame 0, where ulps are small
  /// relative to the segment, within one. Requires: start <= frame <= end.
  Place place_of(double frame) const;

  /// The same for nearly all frames, as fast as possible; q <= 0 if the fast method does not
  /// suffice.
  Place quick_place_of(double frame) const;

  /// Frames from one end, over q.
  Cubic from_end(int end) const { return {0, c1_[end], c2_[end], c3_}; }

 private:
  // Initial guesses of the inverse: polynomials on eighths of the parameter, four for each end.
  static constexpr int piece_count = 8;
  static constexpr int degree = 6;
  // The middle of a segment belongs to both ends; rounding may put the root a little beyond 1/2.
  static constexpr double largest_place = 0.5 + 0x1p-10;

  // In the second half q decreases from piece to piece.
  static constexpr std::array<float, piece_count> first_qs = {0,    0.125F, 0.25F, 0.375F,
                                                              0.5F, 0.375F, 0.25F, 0.125F};

  /// q = first_q + c[0] s + c[1] s² + … with s, in lengths of the segment, counted from the start
  /// of the piece. A guess needs few digits: its error enters with the fourth power.
  using Piece = std::array<float, degree>;

  struct Guess {
    int end = 0;
    double distance = 0;  ///< from that end [frames]
    double q = 0;
  };

  /// A step from q towards the root, of fourth order (eq. 5).
  struct Step {
    double length = 0;
    bool is_last = false;  ///< no digit is left to improve; false if q is NaN
  };

  Guess guess_of(double frame) const;
  static Step step_from(double q, const Cubic& x, double miss);
  Place careful_place_of(double frame) const;
  Place search(int end, Pair distance) const;
  double residual(int end, double q, Pair distance) const;
  double roundings(int end) const;
  Piece piece_of(int piece, double length) const;

  // In the order of use: a frame needs two cache lines and half of one of the next two.
  std::array<double, piece_count - 1> joints_ = {};   ///< between pieces, from the start [frames]
  std::array<float, piece_count> first_shares_ = {};  ///< of the length, at the starts of pieces
  float per_length_ = 0;                              ///< 1 / length
  bool has_small_frames_ = false;      ///< plain doubles would be wrong by several ulp
  std::array<double, 2> frames_ = {};  ///< of the ends
  std::array<double, 2> c1_ = {};      ///< of x as seen from the ends (eq. 4) [frames]
  std::array<double, 2> c2_ = {};
  double c3_ = 0;
  std::array<Piece, piece_count> pieces_;
  // The low parts of the numbers above.
  std::array<double, 2> c1_low_ = {};
  std::array<double, 2> c2_low_ = {};
  double c3_low_ = 0;
};

// Inline, since a curve spends most of its time here.

// The latency of dependent operations counts, not their number; so sums are grouped in pairs
// instead of by Horner's rule if their last digits do not matter.

inline TimeCubic::Guess TimeCubic::guess_of(double frame) const {
  const double elapsed = frame - frames_[0];
  // No branch on values that change from frame to frame.
  const auto is_behind = [&](int joint) { return elapsed >= joints_[joint - 1] ? 1 : 0; };
  const int piece = ((is_behind(1) + is_behind(2)) + (is_behind(3) + is_behind(4))) +
                    ((is_behind(5) + is_behind(6)) + is_behind(7));
  const Piece& c = pieces_[piece];
  const float s = static_cast<float>(elapsed * per_length_) - first_shares_[piece];
  const float s_2 = s * s;
  const int end = piece / (piece_count / 2);
  return {end, std::fabs(frame - frames_[end]),
          ((first_qs[piece] + c[0] * s) + s_2 * (c[1] + c[2] * s)) +
              (s_2 * s_2) * ((c[3] + c[4] * s) + s_2 * c[5])};
}

inline TimeCubic::Step TimeCubic::step_from(double q, const Cubic& x, double miss) {
  // With n = miss/x', A = x"/(2x'), B = x"'/(6x').
  const double inverse = 1 / ((x.c1 + 2 * x.c2 * q) + 3 * x.c3 * (q * q));
  const double n = miss * inverse;
  const double a = x.half_curvature(q) * inverse;
  const double b = x.c3 * inverse;
  const double n_2 = n * n;
  const double a_2 = a * a;
  // The remaining error is less than 10 g^(3/2) n for g = (A² + |B|) n²; the goal is 2^-56 of q.
  const double g = (a_2 + std::fabs(b)) * n_2;
  return {(n - n_2 * a) + (n_2 * n) * (2 * a_2 - b), (g * g) * (g * n_2) < 0x1p-119 * (q * q)};
}

inline TimeCubic::Place TimeCubic::quick_place_of(double frame) const {
  if (has_small_frames_) return {0, -1, 0};
  const Guess guess = guess_of(frame);
  const Cubic x = from_end(guess.end);
  double q = guess.q;
  for (int round = 0; round < 2; ++round) {  // the first usually suffices
    const Step step = step_from(q, x, guess.distance - q * (x.c1 + q * (x.c2 + q * x.c3)));
    const bool is_last = q <= largest_place && step.is_last;
    q += step.length;
    if (is_last) return {guess.end, q, 0};
  }
  return {0, -1, 0};
}

inline TimeCubic::Place TimeCubic::place_of(double frame) const {
  const Place place = quick_place_of(frame);
  return place.q > 0 ? place : careful_place_of(frame);
}

}  // namespace pliant::timeline
