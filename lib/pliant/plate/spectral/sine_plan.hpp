#pragma once

#include <cstddef>
#include <vector>

#include "pliant/plate/kernels/kernels.hpp"

namespace pliant {

/// The tables of a sine transform of one length. Internal to plate.
class SinePlan {
 public:
  SinePlan() = default;
  /// Requires: length >= 2.
  explicit SinePlan(int length);

  int length() const { return length_; }

  /// Valid until the plan is moved or destroyed.
  SineView view() const;

  /// Number of doubles in the tables, and an upper bound for a plan of a given length.
  std::size_t size() const;
  static std::size_t most_size(int length);

 private:
  void set_stages(int length, std::vector<int> radices);
  void make_fold();
  void make_places();
  void make_chirp();
  void make_powers();

  int length_ = 0;
  int fourier_length_ = 0;
  std::vector<int> radices_;
  std::vector<double> tables_;
  std::vector<double> fold_;
  std::vector<int> places_;
  std::vector<double> chirp_;
  std::vector<int> in_evens_, out_evens_;
  std::vector<double> in_turns_, out_turns_;
  std::vector<double> kernel_;
};

/// Cosine and sine of 2 pi numerator/denominator, the angle reduced to an eighth of a turn without
/// rounding. Requires: 0 <= numerator, 0 < denominator < 2^40.
struct TurnPoint {
  double cosine = 1;
  double sine = 0;
};
TurnPoint turn_point(long numerator, long denominator);

}  // namespace pliant
