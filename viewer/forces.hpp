#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/feedback/frame_report.hpp"
#include "pliant/feedback/surface_lines.hpp"
#include "pliant/sampling/rest_shape.hpp"
#include "pliant/scene/channel_values.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/simulation/simulation.hpp"
#include "viewer/json.hpp"
#include "viewer/lines.hpp"

namespace pliant::viewer {

/// The value at each frame, or a single value if all are equal.
Json track(const FrameSpan& frames, const std::function<Json(int frame)>& value_at);
Json track(const FrameSpan& frames, const ValueAt& value_at);

/// The forces and groups of a scene as a page draws them: their places in the world and radii at
/// each frame. Thesis 5.2.2.
///
/// An array with one object for each, forces first. A parameter is an array with a value for each
/// frame, or with a single value if it is constant. Errors: Interrupted.
Result<Json> view_forces(const Simulation& simulation, const FrameSpan& frames,
                         const StopRequest& should_stop = {});

/// The regions and the boxes of forces that a page draws on one surface, stored only at frames
/// where they change. Of a grid whose nodes are vertices they are boxes, otherwise lines.
class SurfaceMarks {
 public:
  /// Requires: `shape` outlives it.
  explicit SurfaceMarks(const RestShape& shape);

  /// `force_numbers`: the index of each name in the result of `view_forces`.
  void add(int frame, const SurfaceReport& report,
           const std::map<std::string, std::size_t, std::less<>>& force_numbers);

  /// An array of objects, each with the first `frame` for which it is valid.
  const Json& changes() const { return changes_; }

  const PackedLines& lines() const { return lines_; }

 private:
  std::optional<LinesOnMesh> mesh_;  // null: a grid whose nodes are vertices
  PackedLines lines_;
  Json changes_ = Json::array();
  Json last_;
};

}  // namespace pliant::viewer
