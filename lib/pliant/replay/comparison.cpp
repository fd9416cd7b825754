#include "pliant/replay/comparison.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/result.hpp"
#include "pliant/core/shortened.hpp"

namespace pliant {
namespace {

// Text of a log for a message.
std::string told(std::string_view text) {
  constexpr std::size_t longest = 200;
  return shortened(printable(text), longest);
}

// The first line in which two texts differ, counted from 1.
long first_other_line(std::string_view a, std::string_view b) {
  const auto [in_a, in_b] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  return 1 + std::count(a.begin(), in_a, '\n');
}

// The first of many, each as `text_of` tells it.
template <class Each, class TextOf>
std::string list_of(const std::vector<Each>& all, const TextOf& text_of) {
  constexpr std::size_t most = 12;
  std::string text;
  for (std::size_t k = 0; k < std::min(all.size(), most); ++k)
    text += (text.empty() ? "" : ", ") + text_of(all[k]);
  return all.size() > most ? fmt::format("{}, … ({} in all)", text, all.size()) : text;
}

std::string list_of(const std::vector<ReplaySurface>& surfaces) {
  return list_of(surfaces, [](const ReplaySurface& surface) {
    const std::string size = surface.columns == 0
                                 ? fmt::format("{} nodes", surface.nodes)
                                 : fmt::format("{} x {}", surface.columns, surface.rows);
    return fmt::format("\"{}\" ({})", told(surface.name), size);
  });
}

std::string list_of(const std::vector<std::string>& changes) {
  if (changes.empty()) return "none";
  return list_of(changes, [](const std::string& change) { return told(change); });
}

// Of files of one name the first.
std::map<std::string_view, Hash> hashes_of(const std::vector<ReplayFile>& files) {
  std::map<std::string_view, Hash> hashes;
  for (const ReplayFile& file : files) hashes.try_emplace(file.name, file.hash);
  return hashes;
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
  std::string text = fmt::format("frame {}: surface \"{}\": {} {}", frame, told(surface), field,
                                 field == "region" ? "differs" : "differ");
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
    causes.push_back(
        fmt::format("the versions of pliant differ: {} and {}", told(a.version), told(b.version)));
  }
  if (a.solver != b.solver || a.factors != b.factors) {
    causes.push_back(fmt::format("the solvers differ: {} ({}) and {} ({})", told(a.solver),
                                 told(a.factors), told(b.solver), told(b.factors)));
  }
  if (a.scene_text != b.scene_text) {
    causes.push_back(fmt::format("the scene {} was edited; the first change is in line {}",
                                 a.scene_file.empty() ? "of the program" : told(a.scene_file),
                                 first_other_line(a.scene_text, b.scene_text)));
  }
  if (a.changes != b.changes) {
    causes.push_back(fmt::format("the changes by --set differ: {}, and {}", list_of(a.changes),
                                 list_of(b.changes)));
  }
  const auto others = hashes_of(b.files);
  for (const ReplayFile& file : a.files) {
    const auto other = others.find(file.name);
    if (other != others.end() && other->second != file.hash) {
      causes.push_back(fmt::format("the file {} was changed", told(file.name)));
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
