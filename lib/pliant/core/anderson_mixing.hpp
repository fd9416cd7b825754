#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

namespace pliant {

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
