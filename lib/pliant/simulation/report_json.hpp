#pragma once

#include <string>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/feedback/frame_report.hpp"

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

}  // namespace pliant
