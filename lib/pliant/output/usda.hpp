#pragma once

#include <memory>

#include "pliant/output/writer.hpp"

namespace pliant {

/// Universal Scene Description as text, one file: an `Xform` "scene", the default prim, with a
/// `Mesh` for each surface. Time codes are frames, and `timeCodesPerSecond` is the scene's fps; +y
/// is up and a unit of length is a metre, since scenes define neither.
///
/// Points, extent, normals and velocities have a sample at each frame. A velocity is the difference
/// to the next frame times fps, in lengths per second, so that motion blur reaches the next sample;
/// at the last frame it is that of the frame before, and it is omitted if there is only one frame.
/// Normals are `vertex`, or `faceVarying` if the mesh defines which corners share one. (u,v) are
/// `primvars:st`, faces stay polygons, materials and groups are GeomSubsets. If poses are placed,
/// transforms are xformOps, sampled if they change.
///
/// A `-` in the name of a surface becomes `_`, since USD does not allow it in names, with a number
/// added if two names would be equal; `displayName` has the original name. The file stores all
/// samples of an attribute together, so they are first collected in files without names: this needs
/// twice the space on the disk.
///
/// Errors: Unwritable; NotFinite beyond single precision.
Result<std::unique_ptr<AnimationWriter>> make_usda_writer(const AnimationPlan& plan);

}  // namespace pliant
