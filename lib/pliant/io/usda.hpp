#pragma once

#include <memory>

#include "pliant/io/writer.hpp"

namespace pliant {

/// Universal Scene Description as text, one file: an `Xform` "scene", the default prim, with a
/// `Mesh` for each surface. Time codes are frames, and `timeCodesPerSecond` is the scene's fps;
/// +y is up and a unit of length a metre, since scenes have none of their own.
///
/// Points, extent, normals and velocities have a sample at each frame. A velocity is the way to the
/// next frame times fps, in lengths per second, so that motion blur meets the next sample; at the
/// last frame it is that of the frame before, and it is left out where there is one frame only.
/// Normals are `vertex`, or `faceVarying` where the mesh says which corners share one. (u,v) are
/// `primvars:st`, faces stay polygons, materials and groups are GeomSubsets. Where poses are
/// placed, transforms are xformOps, sampled if they change.
///
/// A `-` in the name of a surface becomes `_`, since USD has none in names, with a number where two
/// would meet; `displayName` keeps the name as it was. Samples of an attribute stand together in
/// the file, so they are gathered in files without a name first: twice the room on the disk.
///
/// Errors: Unwritable; NotFinite beyond single precision.
Result<std::unique_ptr<AnimationWriter>> make_usda_writer(const AnimationPlan& plan);

}  // namespace pliant
