#include "pliant/feedback/frame_report.hpp"

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "pliant/core/hash_stream.hpp"
#include "pliant/feedback/cut_outline.hpp"
#include "pliant/region/region.hpp"
#include "pliant/sampling/sampling.hpp"

namespace pliant {
namespace {

// Of the nodes in and around the region, and of what is held of each patch.
Hash hash_of_cut(const TriangleSelection& selection) {
  HashStream stream;
  const auto add = [&]<class T>(const std::vector<T>& values) {
    const auto bytes = std::as_bytes(std::span(values));
    stream.add({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  };
  add(selection.level_set.nodes);
  add(selection.level_set.at_nodes);
  add(selection.level_set.at_centres);
  for (const TrianglePatch& patch : selection.patches) {
    const auto held = patch.points.begin() + patch.cells.free_points;
    add(std::vector(held, patch.points.end()));
  }
  return stream.hash();
}

// Around the part of the region that is nearer to a force than its force radius.
SurfaceLines pushed_part(const Body& body, const SurfaceInputs& inputs,
                         const TriangleSelection& selection, const SampledForce& force) {
  if (!(force.force_radius > 0)) return {};
  Field room;
  const PlacedNodes measured(body.measured(inputs.body, room), inputs.body.transform);
  const std::vector<double> depths =
      depths_of(measured, selection.level_set.nodes, force.kind, force.force_radius);
  return outline_of(selection.patches, selection.level_set, depths);
}

}  // namespace

Result<SurfaceReport> report_of(const Body& body, const SurfaceInputs& inputs,
                                ReportDetail detail) {
  const bool has_outlines = detail == ReportDetail::Outlines;
  const auto step = body.look(inputs.body);
  if (!step) return fail(step.error());
  SurfaceReport report;
  report.is_solved = step->solves();
  report.steps = step->steps;
  report.unknown_count = step->unknown_count();
  report.recovering = static_cast<int>(step->recovering.size());
  report.settled = static_cast<int>(step->settling.size());
  report.selected = step->selection.box();
  report.regions = step->selection.regions;
  if (step->surface) {
    report.is_surface = true;
    report.cut = hash_of_cut(*step->surface);
    for (const TrianglePatch& patch : step->surface->patches) {
      report.patches.push_back(patch.counts(step->surface->level_set));
      if (has_outlines)
        report.outlines.push_back({patch.moves(), outline_of(patch, step->surface->level_set)});
    }
  }
  for (std::size_t k = 0; k < inputs.body.forces.size(); ++k) {
    ForceReport& force = report.forces.emplace_back();
    force.name = inputs.sources[k].name;
    force.kind = inputs.sources[k].kind;
    force.sampled = std::make_shared<SampledForce>(inputs.body.forces[k]);
    force.push = body.push_of(inputs.body, *step, k);
    if (step->surface) {
      force.counts = step->surface->forces[k].counts;
      if (has_outlines)
        force.outline = pushed_part(body, inputs, *step->surface, inputs.body.forces[k]);
    } else {
      force.selection = step->selection.forces[k];
    }
  }
  if (std::string fault = inputs.faults->first(); !fault.empty()) {
    return fail(ErrorCode::NotFinite, std::move(fault));
  }
  return report;
}

}  // namespace pliant
