#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pliant/feedback/surface_lines.hpp"
#include "viewer/arrays.hpp"
#include "viewer/json.hpp"

namespace pliant::viewer {

/// Lines between the vertices of one mesh, packed for a page. Lines that come again are stored
/// once.
class PackedLines {
 public:
  /// The place of the lines: first point, number of points, first segment, number of segments.
  Json add(const SurfaceLines& lines);

  bool is_empty() const { return counts_.empty(); }

  /// An object with the arrays of all lines. Points and segments count from those of their lines.
  Json arrays(Arrays& arrays) const;

 private:
  std::vector<std::uint32_t> counts_;  // of each point: its entries
  std::vector<std::int32_t> sources_;  // as in SurfaceLines
  std::vector<float> shares_;
  std::vector<std::uint32_t> segments_;  // two points each
  std::map<std::string, Json> places_;   // by the hash of the lines
};

}  // namespace pliant::viewer
