#pragma once

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/mesh/mesh.hpp"
#include "pliant/mesh/triangles/triangle_surface.hpp"
#include "pliant/mesh/written/subdivision.hpp"
#include "pliant/mesh/written/vertex_weights.hpp"

namespace pliant {

/// A cage that was refined: its control points are the cage's nodes.
struct SubdividedMesh {
  /// In OpenSubdiv's order. Vertices of level 0: the nodes of faces that take part, ascending; of
  /// each further level: those at the vertices of the level before, at its faces (Catmull-Clark
  /// only), at its edges. Faces: those of a face of the level before, in the order of its corners.
  /// A face has the material and the group of the face that it comes from. A corner has a UV if
  /// all that it depends on have one. No normals, no numbers of vertices in a file.
  Mesh mesh;

  VertexWeights weights;  ///< nodes of the cage -> vertices, nodes ascending within a vertex
};

/// The size of a cage that is refined. `surface` is `mesh` read as a surface. Errors: a build
/// without OpenSubdiv; levels out of range; Loop's scheme and a face that is no triangle; more
/// than 65535 corners of a face, edges or faces at a node, or faces at an edge; a mesh that is
/// larger than `WrittenSize` allows. Cost: one pass over the faces, whatever the levels.
Result<WrittenSize> check_subdivision(const Mesh& mesh, const TriangleSurface& surface,
                                      const Subdivision& subdivision);

/// Refines a cage uniformly, not pushed to the limit. Border edges and corners are interpolated,
/// UVs by the rule "corners plus 1", where UVs that are equal at one node are one. Errors: those of
/// `check_subdivision`; a cage that OpenSubdiv refuses; Interrupted, but not while OpenSubdiv
/// makes its topology.
Result<SubdividedMesh> subdivide(const Mesh& mesh, const TriangleSurface& surface,
                                 const Subdivision& subdivision,
                                 const StopRequest& should_stop = {});

}  // namespace pliant
