#pragma once

#include <memory>

#include "pliant/files/surface_writer.hpp"
#include "pliant/files/writer.hpp"

namespace pliant {

/// A NumPy array of float64, C order, shape (frames, vertices, 3): format version 1.0 of
/// numpy.lib.format. Streams: only one frame is in memory at a time.
Result<std::unique_ptr<SurfaceWriter>> make_npy_writer(const SurfacePlan& plan);

/// One Wavefront OBJ file per frame, written by `ObjText`. Errors: Unwritable.
Result<std::unique_ptr<SurfaceWriter>> make_obj_writer(const SurfacePlan& plan);

/// One binary PLY file per frame, little-endian: `double x y z` of each vertex, so every bit of a
/// position, and the faces as in the source mesh. With `float nx ny nz` if the mesh defines which
/// corners share a normal and each vertex has only one. With `double s t` if each vertex has only
/// one (u,v) over all its corners; otherwise each face has a list `texcoord` of u v u v …, which
/// fewer programs support. PLY cannot store materials and groups. Written by `PlyBytes`.
Result<std::unique_ptr<SurfaceWriter>> make_ply_writer(const SurfacePlan& plan);

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

/// The most frames in a glTF file: each may be a shape of its own, and each shape has a weight at
/// each frame, which makes frames x frames numbers.
inline constexpr int most_gltf_frames = 8192;

/// glTF 2.0: `.gltf` with its numbers in OUT.0123456789abcdef.bin, or `.glb` with both in one file.
/// The digits are those of the hash of the numbers. A .gltf replaces an older one in one step,
/// after its numbers are in place; then number files that no .gltf of the folder refers to any more
/// are removed.
///
/// A node, a mesh and an animation channel for each surface, then for each collider. The mesh is
/// the surface at rest. Each frame that differs from the one before is a morph target, with sparse
/// offsets if they are smaller; it has weight 1 at its time and 0 at those of all others. Between
/// frames the weights are linear, and so is the shape. Base and offsets are single precision: the
/// error of their sum is at most half a unit in the last place of the position plus that of the
/// offset. Times are in seconds from the first frame.
///
/// Faces are split into triangles. The vertices of the mesh come first, in its order, followed by
/// those that a seam of (u,v) or a hard edge splits off. v points downwards in glTF: it is 1 - v.
/// If poses are placed, nodes have translation, rotation and scale, animated if they change. Those
/// of colliders always have; one that is not shown has a scale of 0, and if that changes its scales
/// are steps.
///
/// Errors: InvalidInput for more than `most_gltf_frames`; Unwritable, also for a `.glb` that
/// exceeds the 4 GiB limit of its header; NotFinite beyond single precision.
Result<std::unique_ptr<AnimationWriter>> make_gltf_writer(const AnimationPlan& plan);

/// Universal Scene Description as text, one file: an `Xform` "scene", the default prim, with a
/// `Mesh` for each surface. Time codes are frames, and `timeCodesPerSecond` is the scene's fps; +y
/// is up and a unit of length is a metre, since scenes define neither.
///
/// Points, extent, normals and velocities have a sample at each frame. A velocity is the difference
/// to the next frame times fps, in lengths per second, so that motion blur reaches the next sample;
/// at the last frame it is that of the frame before, and it is omitted if there is only one frame.
/// Normals are `vertex`, or `faceVarying` if the mesh defines which corners share one. (u,v) are
/// `primvars:st`, faces stay polygons, materials and groups are GeomSubsets. If poses are placed,
/// transforms are xformOps, sampled if they change. Colliders follow, always placed: their points,
/// extent and normals have samples only where they change, and they have a visibility.
///
/// A `-` in the name of a surface becomes `_`, since USD does not allow it in names, with a number
/// added if two names would be equal; `displayName` has the original name. The file stores all
/// samples of an attribute together, so they are first collected in files without names: this needs
/// twice the space on the disk.
///
/// Errors: Unwritable; NotFinite beyond single precision.
Result<std::unique_ptr<AnimationWriter>> make_usda_writer(const AnimationPlan& plan);

}  // namespace pliant
