#include "pliant/feedback/frame_report.hpp"

#include <utility>

#include "pliant/region/region.hpp"
#include "pliant/sampling/sampling.hpp"

namespace pliant {

Result<SurfaceReport> report_of(const Body& body, const SurfaceInputs& inputs) {
  const auto step = body.look(inputs.body);
  if (!step) return fail(step.error());
  SurfaceReport report;
  report.is_solved = step->solves();
  report.steps = step->steps;
  report.unknown_count = step->unknown_count();
  report.recovering = static_cast<int>(step->recovering.size());
  report.settled = static_cast<int>(step->settling.size());
  report.regions = step->selection.regions;
  for (std::size_t k = 0; k < inputs.body.forces.size(); ++k) {
    report.forces.push_back({std::string(inputs.sources[k].name), inputs.sources[k].kind,
                             std::make_shared<SampledForce>(inputs.body.forces[k]),
                             step->selection.forces[k], body.push_of(inputs.body, *step, k)});
  }
  if (std::string fault = inputs.faults->first(); !fault.empty()) {
    return fail(ErrorCode::NotFinite, std::move(fault));
  }
  return report;
}

}  // namespace pliant
