#pragma once

#include <memory>

#include "pliant/output/writer.hpp"

namespace pliant {

/// The most frames in a glTF file: each may be a shape of its own, and each shape has a weight at
/// each frame, which makes frames x frames numbers.
inline constexpr int most_gltf_frames = 8192;

/// glTF 2.0: `.gltf` with its numbers in OUT.0123456789abcdef.bin, or `.glb` with both in one file.
/// The digits are those of the hash of the numbers. A .gltf replaces an older one in one step,
/// after its numbers are in place; then number files that no .gltf of the folder refers to any more
/// are removed.
///
/// A node, a mesh and an animation channel for each surface. The mesh is the surface at rest. Each
/// frame that differs from the one before is a morph target, with sparse offsets if they are
/// smaller; it has weight 1 at its time and 0 at those of all others. Between frames the weights
/// are linear, and so is the shape. Base and offsets are single precision: the error of their sum
/// is at most half a unit in the last place of the position plus that of the offset. Times are in
/// seconds from the first frame.
///
/// Faces are split into triangles. The vertices of the mesh come first, in its order, followed by
/// those that a seam of (u,v) or a hard edge splits off. v points downwards in glTF: it is 1 - v.
/// If poses are placed, nodes have translation, rotation and scale, animated if they change.
///
/// Errors: InvalidInput for more than `most_gltf_frames`; Unwritable, also for a `.glb` that
/// exceeds the 4 GiB limit of its header; NotFinite beyond single precision.
Result<std::unique_ptr<AnimationWriter>> make_gltf_writer(const AnimationPlan& plan);

}  // namespace pliant
