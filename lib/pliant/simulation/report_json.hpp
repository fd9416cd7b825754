#pragma once

#include <string>

#include "pliant/core/grid.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/feedback/frame_report.hpp"
#include "pliant/region/selection.hpp"

namespace pliant {

class LiveSimulation;
class Simulation;

/// The report of a frame as JSON, in one line: the entry of the frame in the file that `pliant bake
/// --regions` writes; docs/regions.md. Requires: the simulation made the report, and is still at
/// its frame if it is live. Errors: Interrupted.
Result<std::string> to_json(const FrameReport& report, const Simulation& simulation,
                            const StopRequest& should_stop = {});
Result<std::string> to_json(const FrameReport& report, const LiveSimulation& live,
                            const StopRequest& should_stop = {});

// Parts of a report as values of nlohmann::basic_json, in its own way.

/// Columns and rows, both ends included, those of a closed grid counted on beyond its end; null: an
/// empty box.
template <class Json>
void to_json(Json& json, const Box& box) {
  if (box.is_empty()) {
    json = nullptr;
  } else {
    json = {{"columns", {box.i0, box.i1}}, {"rows", {box.j0, box.j1}}};
  }
}

template <class Json>
void to_json(Json& json, const CutCounts& counts) {
  json = {{"insideNodes", counts.inside_nodes},
          {"heldNodes", counts.held_nodes},
          {"cells", counts.cells}};
}

}  // namespace pliant
