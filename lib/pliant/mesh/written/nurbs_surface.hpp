#pragma once

#include "pliant/core/grid.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/mesh/mesh.hpp"
#include "pliant/mesh/written/nurbs_net.hpp"
#include "pliant/mesh/written/vertex_weights.hpp"

namespace pliant {

/// A NURBS net as the grid of its control points, and the surface that is written of it.
struct NurbsSurface {
  /// Node (i,j) is control point (i,j), at u = i/(columns - 1), closed i/columns; v likewise.
  Grid grid;

  /// Vertex l*samplesU + k is at even parameters, ends included; closed: the end left out. Quads,
  /// turned like those of a `GridSheet`. UV of sample k: k/(samplesU - 1), closed k/samplesU, and 1
  /// at the end of the last quad of a closed direction, which the uvs have one more of.
  Mesh mesh;

  VertexWeights weights;  ///< control points -> vertices
};

/// The surface S(s,t) = sum of N_i(s) N_j(t) g_ij p_ij / sum of N_i N_j g_ij, with the B-splines N
/// by Cox and de Boor: over the knots k from k_degree to k_count; closed: over 0, 1, 2, ... from
/// degree to degree + count, with indices modulo count. Requires: `check_net` accepts the net.
/// Source: Piegl & Tiller, The NURBS Book, eq. (2.5) and (4.11), algorithm A2.2.
NurbsSurface make_nurbs(const NurbsNet& net);

/// The same. Errors: Interrupted.
Result<NurbsSurface> make_nurbs(const NurbsNet& net, const StopRequest& should_stop);

/// The control points as vertices, with a quad between any four neighbours. Requires: `check_net`
/// accepts the net.
Mesh control_mesh(const NurbsNet& net);

}  // namespace pliant
