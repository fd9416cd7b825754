#pragma once

#include <span>

#include "pliant/plate/plate.hpp"
#include "pliant/plate/time_steps.hpp"

namespace pliant {

struct ExcitedMode;

// How a plate swings and comes to rest, in nature and under backward Euler, whose steps take energy
// away. docs/model.md, eq. (38) to (42).

/// A vibration as it is seen.
struct Swing {
  double frequency = 0;      ///< [Hz]; 0: it creeps back without swinging
  double damping_ratio = 0;  ///< [1], below 1 it swings; infinite without inertia
};

/// The vibration of eigenvalue `lambda` [1/uv^4] in nature, undamped in frequency: rho q'' + eta q'
/// + lambda q = 0. Requires: lambda > 0.
Swing natural_swing(double lambda, const Dynamics& dynamics);

/// The same as an animation of frames of `frame_length` [s] has it, frequency included, each of
/// them made by `steps`. Requires: lambda > 0, frame_length > 0.
Swing stepped_swing(double lambda, const Dynamics& dynamics, const TimeSteps& steps,
                    double frame_length);

/// When something that a load is put on, at rest, stays near where the load holds it.
struct Settling {
  double time = 0;         ///< between two frames, where it comes near for good [s]
  int frames = 0;          ///< the first frame from which on it is near, counted from the load's
  bool is_counted = true;  ///< false: it takes so long that `time` is that of the slowest part's
                           ///< envelope, and `frames` are as long
};

/// From which frame on a node stays within `part` of its displacement under a load that is put on
/// at frame 0 and held. `modes` are the node's, as `excited_modes` has them. Requires: there are
/// some; 0 < part < 1; frame_length > 0. At most some 10^7 multiplications.
Settling settling_of(std::span<const ExcitedMode> modes, const Dynamics& dynamics,
                     const TimeSteps& steps, double frame_length, double part = 0.05);

}  // namespace pliant
