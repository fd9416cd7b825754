#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/plate/solver_choice.hpp"
#include "pliant/sweep/sweep.hpp"
#include "pliant/sweep/takes.hpp"

namespace pliant {

/// What is asked of a sweep in a folder, as typed.
struct SweepRequest {
  std::vector<std::string> scenes = {};  ///< files
  SweepVariation variation = {};         ///< its `scene_count` is that of the scenes
  std::optional<FrameSpan> frames = {};
  SolverChoice solver = SolverChoice::Auto;
  std::string root = {};   ///< as in `load_scene`
  std::string write = {};  ///< ending of the animations, `.npy`; empty: only the table is made
};

}  // namespace pliant
