#pragma once

#include <map>
#include <string>
#include <vector>

#include "frame_range.hpp"
#include "json.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/simulation/frame_report.hpp"

namespace pliant::cli {

/// What a page draws of the forces and groups of a scene: where they are and how far they reach,
/// frame by frame, as their channels have it. Thesis 5.2.2.
///
/// An array with an object for each, forces first. A parameter is an array with a value for each
/// frame, or with one value if it is the same at all.
Json view_forces(const Scene& scene, const FrameRange& frames);

/// What a page draws on one surface: the regions that are solved and the boxes of the forces, kept
/// where they change.
class SurfaceMarks {
 public:
  /// `force_numbers` has the place of each name in what `view_forces` gives.
  void add(int frame, const SurfaceReport& report,
           const std::map<std::string, std::size_t, std::less<>>& force_numbers);

  /// An array of objects, each with the first `frame` that it is for.
  const Json& changes() const { return changes_; }

 private:
  Json changes_ = Json::array();
  Json last_;
};

}  // namespace pliant::cli
