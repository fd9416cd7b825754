#pragma once

#include <memory>

#include "pliant/output/surface_writer.hpp"

namespace pliant {

// Point caches contain only positions, in single precision, so each comes with the mesh that they
// move: OUT.obj beside OUT.pc2 or OUT.mdd, at rest, its vertices in the order of the cache. Both
// appear at the end, the mesh first. Axes are the scene's. Only one frame is in memory at a time.

/// PC2, version 1, little-endian: "POINTCACHE2\0", then version, vertices, first frame (float),
/// frames from one sample to the next (float, 1), samples; then x y z of each vertex of each
/// sample. Errors: Unwritable.
Result<std::unique_ptr<SurfaceWriter>> make_pc2_writer(const SurfacePlan& plan);

/// MDD, big-endian: frames, vertices; the time of each frame in seconds from the first; then x y z
/// of each vertex of each frame. Errors: Unwritable.
Result<std::unique_ptr<SurfaceWriter>> make_mdd_writer(const SurfacePlan& plan);

}  // namespace pliant
