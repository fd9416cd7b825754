#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "pliant/replay/log.hpp"

namespace pliant {

/// One thing at one frame that is not as it was recorded.
struct ReplayDifference {
  int frame = 0;
  std::string surface;
  std::string field;  ///< positions, velocities or region

  /// Where both states are known, the node (i, j) whose vector differs most, the first of several,
  /// and by what length [unit of the field]; 0 where a sign of zero differs. None where a state is
  /// not known, and for a region.
  std::optional<std::array<int, 2>> node = {};
  double size = 0;

  /// Of positions: the largest displacement as recorded, and as it is now. [length]
  std::optional<std::array<double, 2>> peaks = {};

  /// One line: `frame 12: surface "sheet": positions differ, most at node (3,4), by 1e-16`.
  std::string message() const;
};

/// What a comparison found.
struct ReplayVerdict {
  /// What explains differences, or might: another version, an edited scene, a changed file. One
  /// line each.
  std::vector<std::string> causes;

  /// What makes frames incomparable: other surfaces, grids or frames. One line each.
  std::vector<std::string> mismatches;

  /// In the order of frames, surfaces and fields; the first only, unless asked to keep going.
  std::vector<ReplayDifference> differences;

  long frame_count = 0;  ///< compared

  bool holds() const { return mismatches.empty() && differences.empty(); }

  /// The first things to say when it does not hold, a line each: causes, mismatches, differences.
  std::vector<std::string> lines() const;
};

// Not for other rooms.

/// What tells two runs apart before any frame is looked at: version, solver, scene, files.
std::vector<std::string> causes_in(const ReplayHeader& a, const ReplayHeader& b);

/// Other surfaces, grids or frames.
std::vector<std::string> mismatches_in(const ReplayHeader& a, const ReplayHeader& b);

/// The last frame that can be compared; before the first one where none can.
long last_comparable_frame(const ReplayHeader& a, const ReplayHeader& b);

/// Compares one frame. Requires: both have the surfaces of `header`.
std::vector<ReplayDifference> differences_in(const ReplayHeader& header, const ReplayFrame& a,
                                             const ReplayFrame& b);

}  // namespace pliant
