#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/body/state.hpp"
#include "pliant/core/hash.hpp"
#include "pliant/core/result.hpp"
#include "pliant/feedback/surface_lines.hpp"
#include "pliant/plate/time_steps.hpp"
#include "pliant/region/selection.hpp"

namespace pliant {

class Body;
struct SampledForce;
struct SurfaceInputs;

/// A force, or the region of a group, that is enabled at a frame and targets the surface.
struct ForceReport {
  std::string name;       ///< of the force, or of the group whose region it is
  std::string_view kind;  ///< the name of its element: point, ..., group; "custom"
  /// Centre, radii, direction, magnitude at the frame, world space: see forces/force.hpp. Never
  /// null. A falloff curve is owned by the simulation's scene.
  std::shared_ptr<const SampledForce> sampled;
  ForceSelection selection;  ///< its boxes in nodes, and the index of its region
  Push push;                 ///< its effect on the nodes that move
  CutCounts counts = {};     ///< on a surface of triangles: of its own sphere
  /// On a surface of triangles, with `ReportDetail::Outlines`: around the part of the region that
  /// is nearer than its force radius, between nodes.
  SurfaceLines outline = {};
};

/// The solve at a frame, on one surface. SPEC 5, 6.
struct SurfaceReport {
  bool is_solved = false;           ///< false: the state does not change
  int frame = 0;                    ///< whose channels it uses: in a loop, of the first cycle
  TimeSteps steps;                  ///< of the solve
  int unknown_count = 0;            ///< nodes that move
  int recovering = 0;               ///< nodes solved because they are not back at rest
  int settled = 0;                  ///< nodes set to rest before the solve
  Box selected;                     ///< the smallest around all regions
  std::vector<Region> regions;      ///< also those too small to solve
  std::vector<ForceReport> forces;  ///< in the order of the scene, then those of groups
  /// What colliders did in the solve before, which led to this frame: they hold back the nodes as
  /// they are now.
  std::vector<ContactFacts> contacts = {};

  /// On a surface of triangles, which has patches in place of regions.
  bool is_surface = false;
  std::vector<CutCounts> patches = {};
  std::vector<PatchOutline> outlines = {};  ///< of the patches, with `ReportDetail::Outlines`
  /// Of phi at the nodes in and around the region, and of what is held; none: the surface is
  /// disabled, or not started.
  std::optional<Hash> cut = {};
};

/// What a report contains.
enum class ReportDetail {
  Counts,    ///< no outlines
  Outlines,  ///< all
};

/// The solve of a body in its present state with these inputs. Errors: as `Body::look`; NotFinite
/// if a custom force returns an invalid value. Not for programs.
Result<SurfaceReport> report_of(const Body& body, const SurfaceInputs& inputs, ReportDetail detail);

/// The solve at one frame, which computes the next frame's mesh from this frame's.
struct FrameReport {
  int frame = 0;
  std::vector<SurfaceReport> surfaces;  ///< in the order of the scene
};

}  // namespace pliant
