#pragma once

#include <vector>

#include "pliant/simulation/frame.hpp"

namespace pliant::viewer {

/// The displacements of all surfaces of a scene over its frames, in the world. A step is the change
/// of all of them from one frame to the next.
struct MotionCourse {
  std::vector<double> displaced;  ///< #frames: the largest displacement [length]
  /// #frames: the length of the step from the frame before, the root of the sum of the squares over
  /// all vertices; 0 for the first. [length]
  std::vector<double> steps;
  /// #frames: the step from the frame before times that to the frame after, summed over vertices;
  /// below 0 where the motion turns back, 0 at both ends. [length^2]
  std::vector<double> turns;
};

/// Follows the surfaces of a scene frame by frame. Requires: frames come in order.
class CourseFollower {
 public:
  /// `rest` is #vertices x 3, object space, for each surface that is not animated.
  void add(const Frame& frame, const std::vector<const Field*>& rest);

  const MotionCourse& course() const { return course_; }

 private:
  MotionCourse course_;
  std::vector<Field> before_;  // of each surface, displacements of the frame before, world
  std::vector<Field> steps_;   // and the step to them
};

/// Which frames tell a motion, by their index, in order: the first and the last, that with the
/// largest displacement, then others at which the displacement has a peak or the motion turns back,
/// first those with the longest way from or to the next of them; what is left are frames amid the
/// widest gaps. `most` of them, at least 3, or all if there are fewer. docs/viewer.md has the rule;
/// script/render follows it too.
std::vector<int> telling_frames(const MotionCourse& course, int most);

}  // namespace pliant::viewer
