#pragma once

#include <algorithm>

#include "pliant/plate/exact/pade.hpp"
#include "pliant/plate/time_steps.hpp"

namespace pliant {

/// A step of the exact integrator: e^(hB) by `poles`. For pole p, with s = p/h,
///
///   (K + (rho s^2 + eta s) M) x = (K w - f)/h - f'/p - (rho s/h) M v
///
/// and then w' = w + 2 Re sum of (r/s) x, v' = 2 Re sum of r x. docs/model.md, eq. (8n).
struct SubStep {
  double length;  ///< h [s]

  Complex rate(int pole) const { return poles[pole].place * (1 / length); }  ///< s [1/s]
  double of_lack() const { return 1 / length; }
  Complex of_growth(int pole) const { return reciprocal(poles[pole].place) * -1.0; }

  Complex to_w(int pole) const { return poles[pole].residue * reciprocal(rate(pole)) * 2.0; }
  Complex to_v(int pole) const { return poles[pole].residue * 2.0; }
  Complex to_doubt(int pole) const { return poles[pole].doubt * reciprocal(rate(pole)) * 2.0; }
};

/// The size of a motion before or after a step: of the displacement, or of what the velocity adds
/// to it in half the interval.
inline double size_of_motion(double displacement, double speed, double interval) {
  return std::max(displacement, speed * interval / 2);
}

/// How the steps of one interval are chosen: from what moves in it, and from nothing else. A motion
/// that begins is small in the first step: the first choice then goes on to the end of the
/// interval, to see how large it gets.
class StepChoice {
 public:
  static constexpr int fewest = 3;
  static constexpr int most = 12'288;  ///< not counting parts

  explicit StepChoice(const TimeSteps& steps) : steps_(steps) {}

  int count() const { return count_ * (is_settled_ ? steps_.count : 1); }
  double length() const { return steps_.length / count(); }

  /// After the first step: whether all steps have to be taken before `accepts` is asked. `doubt`:
  /// the size of G(hB) w; the others: those of the motion before and after that step.
  bool looks_ahead(double doubt, double before, double after) const {
    return count_ == fewest && !is_settled_ && after > 2 * before && doubt > tolerance * after;
  }

  /// After the first step, or after all of them: whether these are the steps that the interval is
  /// made of. If not, `count` has grown, and the interval begins again. `scale`: the largest size
  /// of the motion so far.
  bool accepts(double doubt, double scale) {
    if (is_settled_) return true;
    scale_ = std::max(scale_, scale);
    const double ratio = doubt / (tolerance * scale_);
    if (!(doubt > tolerance * scale_) || count_ >= most) {
      is_settled_ = true;
      return steps_.count == 1;
    }
    // What makes the doubt falls off with the frequency, but how steeply is not known.
    int factor = 2;
    while (factor < 16 && double(factor) * factor * factor < ratio) factor *= 2;
    count_ = count_ * factor < most ? count_ * factor : most;
    return false;
  }

 private:
  // So that the errors of 250 frames, with a margin, stay below 1e-6.
  static constexpr double tolerance = 2.5e-7;

  TimeSteps steps_;
  int count_ = fewest;
  double scale_ = 0;
  bool is_settled_ = false;
};

}  // namespace pliant
