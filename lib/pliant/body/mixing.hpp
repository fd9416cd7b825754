#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "pliant/body/state.hpp"

namespace pliant {

// States as lists of numbers, which the search for a cycle combines linearly. Internal to body.

/// The numbers of a state that are combined, all as lengths; what else it has is no number.
std::vector<double> numbers_of(const BodyState& state, double frame_time);

/// `state` with these numbers.
BodyState with_numbers(BodyState state, double frame_time, const std::vector<double>& numbers);

/// How many numbers `numbers_of` makes.
std::size_t number_count(const BodyState& state);

/// Anderson's method for the fixed point of a map: from points x and their images, the next point,
/// at which a linear map would have the smallest residual that a combination of the past ones has.
/// D. G. Anderson, "Iterative procedures for nonlinear integral equations", J. ACM 12, 1965; with
/// the differences of residuals made orthogonal one by one.
class AndersonMixing {
 public:
  /// Keeps at most `depth` past differences, of two lists of numbers each.
  explicit AndersonMixing(std::size_t depth) : depth_(depth) {}

  /// The next point. All lists have one length.
  std::vector<double> next(const std::vector<double>& x, std::vector<double> image);

  /// Forgets the past.
  void clear();

 private:
  // A combination of past differences: of residuals, with length 1, and of images.
  struct Direction {
    std::vector<double> residual;
    std::vector<double> image;
  };

  std::size_t depth_;
  std::deque<Direction> directions_;  // with orthogonal residuals, the oldest first
  std::optional<Direction> last_;     // the residual and image of the last point
};

}  // namespace pliant
