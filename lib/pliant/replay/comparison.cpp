#include "pliant/replay/comparison.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pliant/core/result.hpp"

namespace pliant {
namespace {

// The first line in which two texts differ, counted from 1.
long first_other_line(std::string_view a, std::string_view b) {
  const auto [in_a, in_b] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  return 1 + std::count(a.begin(), in_a, '\n');
}

std::string list_of(const std::vector<ReplaySurface>& surfaces) {
  std::string text;
  for (const ReplaySurface& surface : surfaces) {
    const std::string size = surface.columns == 0
                                 ? fmt::format("{} nodes", surface.nodes)
                                 : fmt::format("{} x {}", surface.columns, surface.rows);
    text += fmt::format("{}\"{}\" ({})", text.empty() ? "" : ", ", printable(surface.name), size);
  }
  return text;
}

const ReplayFile* find(const std::vector<ReplayFile>& files, const std::string& name) {
  const auto found = std::find_if(files.begin(), files.end(),
                                  [&](const ReplayFile& file) { return file.name == name; });
  return found == files.end() ? nullptr : &*found;
}

// By bits: 0 and -0 differ.
bool is_same(const Field& a, const Field& b, Eigen::Index row) {
  for (int component = 0; component < 3; ++component) {
    if (std::bit_cast<std::uint64_t>(a(row, component)) !=
        std::bit_cast<std::uint64_t>(b(row, component))) {
      return false;
    }
  }
  return true;
}

// Finds the node at which two fields of a surface differ most.
void measure(const Field& a, const Field& b, int columns, ReplayDifference& difference) {
  for (Eigen::Index row = 0; row < a.rows(); ++row) {
    if (is_same(a, b, row)) continue;
    const Eigen::RowVector3d gap = b.row(row) - a.row(row);
    const double size = std::hypot(gap[0], gap[1], gap[2]);
    if (difference.node && !(size > difference.size)) continue;
    const int node = static_cast<int>(row);
    difference.node =
        columns == 0 ? std::array{node, -1} : std::array{node % columns, node / columns};
    difference.size = size;
  }
}

// One surface at a frame.
struct SurfaceAtFrame {
  const SurfaceDigest& digest;
  const BodyState* state;  // null: not recorded
};

SurfaceAtFrame surface_of(const ReplayFrame& frame, std::size_t k) {
  return {frame.surfaces[k], frame.states.empty() ? nullptr : &frame.states[k]};
}

}  // namespace

std::string ReplayDifference::message() const {
  std::string text = fmt::format("frame {}: surface \"{}\": {} {}", frame, printable(surface),
                                 field, field == "region" ? "differs" : "differ");
  if (peaks && !node) {
    text += fmt::format("; their peak displacement of {:.6g} differs by {:.3g}", (*peaks)[0],
                        std::abs((*peaks)[1] - (*peaks)[0]));
  }
  if (node) {
    const std::string place = (*node)[1] < 0 ? std::to_string((*node)[0])
                                             : fmt::format("({},{})", (*node)[0], (*node)[1]);
    text += fmt::format(", most at node {}, by {:.3g}", place, size);
  }
  return text;
}

std::vector<std::string> ReplayVerdict::lines() const {
  std::vector<std::string> all = causes;
  all.insert(all.end(), mismatches.begin(), mismatches.end());
  for (const ReplayDifference& difference : differences) all.push_back(difference.message());
  return all;
}

std::vector<std::string> causes_in(const ReplayHeader& a, const ReplayHeader& b) {
  std::vector<std::string> causes;
  if (a.version != b.version) {
    causes.push_back(fmt::format("the versions of pliant differ: {} and {}", printable(a.version),
                                 printable(b.version)));
  }
  if (a.solver != b.solver || a.factors != b.factors) {
    causes.push_back(fmt::format("the solvers differ: {} ({}) and {} ({})", printable(a.solver),
                                 printable(a.factors), b.solver, b.factors));
  }
  if (a.scene_text != b.scene_text) {
    causes.push_back(fmt::format("the scene {} was edited; the first change is in line {}",
                                 a.scene_file.empty() ? "of the program" : printable(a.scene_file),
                                 first_other_line(a.scene_text, b.scene_text)));
  }
  if (a.changes != b.changes) {
    const auto list = [](const std::vector<std::string>& changes) {
      return changes.empty() ? "none" : printable(fmt::format("{}", fmt::join(changes, ", ")));
    };
    causes.push_back(
        fmt::format("the changes by --set differ: {}, and {}", list(a.changes), list(b.changes)));
  }
  for (const ReplayFile& file : a.files) {
    const ReplayFile* const other = find(b.files, file.name);
    if (other && other->hash != file.hash) {
      causes.push_back(fmt::format("the file {} was changed", printable(file.name)));
    }
  }
  return causes;
}

std::vector<std::string> mismatches_in(const ReplayHeader& a, const ReplayHeader& b) {
  std::vector<std::string> mismatches;
  if (a.start != b.start || a.end != b.end) {
    mismatches.push_back(
        fmt::format("the frames differ: {} to {}, and {} to {}", a.start, a.end, b.start, b.end));
  }
  if (a.surfaces != b.surfaces) {
    mismatches.push_back(
        fmt::format("the surfaces differ: {}, and {}", list_of(a.surfaces), list_of(b.surfaces)));
  }
  return mismatches;
}

long last_comparable_frame(const ReplayHeader& a, const ReplayHeader& b) {
  if (a.start != b.start || a.surfaces != b.surfaces) return long{a.start} - 1;
  return std::min(a.end, b.end);
}

std::vector<ReplayDifference> differences_in(const ReplayHeader& header, const ReplayFrame& a,
                                             const ReplayFrame& b) {
  std::vector<ReplayDifference> differences;
  for (std::size_t k = 0; k < header.surfaces.size(); ++k) {
    const ReplaySurface& surface = header.surfaces[k];
    const auto [then, state_then] = surface_of(a, k);
    const auto [now, state_now] = surface_of(b, k);
    const bool has_states = state_then && state_now;
    if (then.positions != now.positions) {
      auto& found = differences.emplace_back(
          ReplayDifference{.frame = a.number, .surface = surface.name, .field = "positions"});
      found.peaks = {then.peak, now.peak};
      if (has_states) measure(state_then->positions, state_now->positions, surface.columns, found);
    }
    if (then.velocities != now.velocities) {
      auto& found = differences.emplace_back(
          ReplayDifference{.frame = a.number, .surface = surface.name, .field = "velocities"});
      if (has_states)
        measure(state_then->velocities, state_now->velocities, surface.columns, found);
    }
    if (then.region != now.region) {
      differences.push_back({.frame = a.number, .surface = surface.name, .field = "region"});
    }
  }
  return differences;
}

}  // namespace pliant
