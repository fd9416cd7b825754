#pragma once

#include <vector>

#include "pliant/plate/swing.hpp"
#include "pliant/plate/vibration.hpp"

namespace pliant {

/// How the node of a region's peak answers to a load that is applied and kept, as a function of
/// density and damping: its modes depend on neither. Internal to feedback.
struct RegionMotion {
  std::vector<ExcitedMode> modes;  ///< of the node, the slowest first; not empty
  double slowest = 0;              ///< the smallest eigenvalue, to which a damping ratio refers
  double drag = 1;           ///< what a map of damping makes of it in the shape of the peak [1]
  bool has_ratio = false;    ///< the damping is given as a ratio
  double frame_seconds = 0;  ///< length of a frame of the scene [s]
  double interval = 0;       ///< the same in the surface's own time [s]
  Stepping stepping = Stepping::Exact;
  TimeSteps swinging = {};  ///< the steps of a frame with density
  TimeSteps creeping = {};  ///< with damping only
  TimeSteps still = {};     ///< with neither

  /// The eigenvalue of the vibration that is most visible: the one with the largest product of
  /// share and period. By share alone it might be one of a bundle of fast ones, which fade at once.
  double seen_lambda() const;

  /// What the vibrations feel of a density and a damping, or damping ratio.
  Dynamics felt(double density, double damping) const;

  /// The inverse: the damping, or damping ratio, of which they feel `felt`; infinite if there is
  /// none. Requires: felt.density > 0 if it is a ratio.
  double damping_of(const Dynamics& felt) const;

  const TimeSteps& steps(const Dynamics& felt) const;

  /// The vibration of `seen_lambda` in the animation.
  Swing swing(const Dynamics& felt) const;

  /// To 5 %, in the animation.
  Settling settling(const Dynamics& felt) const;
};

}  // namespace pliant
