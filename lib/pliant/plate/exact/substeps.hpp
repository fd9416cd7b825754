#pragma once

#include "pliant/plate/exact/pade.hpp"
#include "pliant/plate/time_steps.hpp"

namespace pliant {

/// A step of the exact integrator: e^(hB) by `poles`. For pole p, with s = p/h,
///
///   (K + (rho s^2 + eta s) M) x = (K w - f)/h - f'/p - (rho s/h) M v
///
/// and then w' = w + 2 Re sum of (r/s) x, v' = 2 Re sum of r x. docs/model.md, eq. (8d).
struct SubStep {
  double length;  ///< h [s]

  Complex rate(int pole) const { return poles[pole].place * (1 / length); }  ///< s [1/s]
  double of_lack() const { return 1 / length; }
  Complex of_growth(int pole) const { return reciprocal(poles[pole].place) * -1.0; }

  Complex to_w(int pole) const { return poles[pole].residue * reciprocal(rate(pole)) * 2.0; }
  Complex to_v(int pole) const { return poles[pole].residue * 2.0; }
  Complex to_doubt(int pole) const { return poles[pole].doubt * reciprocal(rate(pole)) * 2.0; }
};

/// How the steps of one interval are chosen: from what moves in it, and from nothing else.
class StepChoice {
 public:
  static constexpr int fewest = 3;
  static constexpr int most = 12'288;  ///< not counting parts

  explicit StepChoice(const TimeSteps& steps) : steps_(steps) {}

  int count() const { return count_ * (is_settled_ ? steps_.count : 1); }
  double length() const { return steps_.length / count(); }

  /// After the first step: whether it is one of those that the interval is made of. If not, `count`
  /// has grown, and the interval begins again. `doubt`: the size of G(hB) w; `scale`: that of the
  /// motion.
  bool accepts(double doubt, double scale) {
    // So that the errors of 250 frames, with a margin, stay below 1e-6.
    constexpr double tolerance = 2.5e-7;
    const double ratio = doubt / (tolerance * scale);
    if (is_settled_) return true;
    if (!(doubt > tolerance * scale) || count_ >= most) {
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
  TimeSteps steps_;
  int count_ = fewest;
  bool is_settled_ = false;
};

}  // namespace pliant
