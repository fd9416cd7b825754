#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "pliant/replay/log.hpp"

namespace pliant {

/// One field at one frame that differs from the recorded one.
struct ReplayDifference {
  int frame = 0;
  std::string surface;
  std::string field;  ///< positions, velocities or region

  /// If both states are known, the node (i, j) whose vectors differ most, the first of several; of
  /// a surface of triangles (node, -1). And the length of the difference [unit of the field]; 0 if
  /// only a sign of zero differs. nullopt if a state is not known, and for a region.
  std::optional<std::array<int, 2>> node = {};
  double size = 0;

  /// For positions: the recorded largest displacement, and the current one. [length]
  std::optional<std::array<double, 2>> peaks = {};

  /// One line: `frame 12: surface "sheet": positions differ, most at node (3,4), by 1e-16`.
  std::string message() const;
};

/// The result of a comparison.
struct ReplayVerdict {
  /// Possible causes of differences: another version, an edited scene, a changed file. One line
  /// each.
  std::vector<std::string> causes;

  /// Reasons why frames cannot be compared: other surfaces, grids or frames. One line each.
  std::vector<std::string> mismatches;

  /// In the order of frames, surfaces and fields; only the first, unless `keeps_going`.
  std::vector<ReplayDifference> differences;

  long frame_count = 0;  ///< number of frames compared

  bool holds() const { return mismatches.empty() && differences.empty(); }

  /// All causes, mismatches and differences, in this order, one line each.
  std::vector<std::string> lines() const;
};

// Internal to replay.

/// Differences known before any frame is compared: version, solver, scene, files.
std::vector<std::string> causes_in(const ReplayHeader& a, const ReplayHeader& b);

/// Differences in surfaces, grids or frames.
std::vector<std::string> mismatches_in(const ReplayHeader& a, const ReplayHeader& b);

/// The last frame that can be compared; less than the first one if none can.
long last_comparable_frame(const ReplayHeader& a, const ReplayHeader& b);

/// Compares one frame. Requires: both frames have the surfaces of `header`.
std::vector<ReplayDifference> differences_in(const ReplayHeader& header, const ReplayFrame& a,
                                             const ReplayFrame& b);

}  // namespace pliant
