#pragma once

#include <span>

#include "pliant/plate/plate.hpp"
#include "pliant/plate/time_steps.hpp"

namespace pliant {

struct ExcitedMode;

// How a plate swings and comes to rest, in continuous time and in steps: those of backward
// Euler remove energy. docs/model.md, eq. (38) to (42).

/// A vibration as an observer sees it.
struct Swing {
  double frequency = 0;      ///< [Hz]; 0: it returns to rest without swinging
  double damping_ratio = 0;  ///< [1], below 1 it swings; infinite without inertia
};

/// The vibration of eigenvalue `lambda` [1/uv^4] in continuous time, with its undamped frequency:
/// rho q'' + eta q' + lambda q = 0. Requires: lambda > 0.
Swing natural_swing(double lambda, const Dynamics& dynamics);

/// These dynamics with the damping that gives the vibration of eigenvalue `lambda` this damping
/// ratio: eta = 2 zeta omega rho, eq. (42a); none without density. Requires: lambda, ratio >= 0.
Dynamics damped_by_ratio(const Dynamics& dynamics, double ratio, double lambda);

/// The same vibration in an animation with frames of `frame_length` [s], each computed by `steps`;
/// its frequency too is that of the animation. Requires: lambda > 0, frame_length > 0.
Swing stepped_swing(double lambda, const Dynamics& dynamics, const TimeSteps& steps,
                    double frame_length);

/// When a body at rest that is put under a load stays near its displacement under that load.
struct Settling {
  double time = 0;         ///< between two frames, when it stays near from then on [s]
  int frames = 0;          ///< the first frame from which on it stays near; 0 is the load's
  bool is_counted = true;  ///< false: it takes too long to count; `time` is that of the slowest
                           ///< part's envelope, infinite if it keeps its energy, and `frames`
                           ///< corresponds to it, up to 10^9
};

/// The time from which on a node stays within `part` of its displacement under a load that is
/// applied at frame 0 and kept. `modes` are those of the node, from `excited_modes`. Requires:
/// `modes` is not empty; 0 < part < 1; frame_length > 0. At most some 10^7 multiplications.
Settling settling_of(std::span<const ExcitedMode> modes, const Dynamics& dynamics,
                     const TimeSteps& steps, double frame_length, double part = 0.05);

}  // namespace pliant
