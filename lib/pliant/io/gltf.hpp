#pragma once

#include <memory>

#include "pliant/io/writer.hpp"

namespace pliant {

/// Most frames that go into a glTF file: each may be a shape of its own, and each shape has a
/// weight at each frame, which is frames x frames numbers.
inline constexpr int most_gltf_frames = 8192;

/// glTF 2.0: `.gltf` with its numbers in OUT.0123456789abcdef.bin, or `.glb` with both in one file.
/// The digits are of the hash of those numbers. A .gltf takes the place of an older one at once,
/// with its numbers already there; then those that no .gltf of the folder names any more are
/// removed.
///
/// A node, a mesh and an animation channel for each surface. The mesh is the surface at rest; each
/// frame that differs from the one before is a morph target, its offsets sparse where that is
/// smaller, and has weight 1 at its time and 0 at those of all others. Between frames the weights
/// are linear, and so is the shape. Base and offsets are single precision: the sum is off by half a
/// unit in the last place of the position and of the offset at most. Times are in seconds from the
/// first frame.
///
/// Faces are split into triangles. The vertices of the mesh come first, in its order, and behind
/// them those that a seam of (u,v) or a hard edge splits off. v runs down in glTF: it is 1 - v.
/// Where poses are placed, nodes have translation, rotation and scale, animated if they change.
///
/// Errors: InvalidInput for more than `most_gltf_frames`; Unwritable, also for a `.glb` that grows
/// beyond the 4 GiB that its header can count; NotFinite beyond single precision.
Result<std::unique_ptr<AnimationWriter>> make_gltf_writer(const AnimationPlan& plan);

}  // namespace pliant
