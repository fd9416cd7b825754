#include "pliant/mesh/vertex_weights.hpp"

namespace pliant {

Field VertexWeights::apply(const Field& at_nodes, Field reuse) const {
  reuse.resize(vertex_count(), 3);
  const double* const x = at_nodes.col(0).data();
  const double* const y = at_nodes.col(1).data();
  const double* const z = at_nodes.col(2).data();
  for (int vertex = 0; vertex < vertex_count(); ++vertex) {
    double sum_x = 0, sum_y = 0, sum_z = 0;
    for (std::size_t entry = starts[vertex]; entry < starts[vertex + 1]; ++entry) {
      const double weight = weights[entry];
      const int node = nodes[entry];
      sum_x += weight * x[node];
      sum_y += weight * y[node];
      sum_z += weight * z[node];
    }
    reuse(vertex, 0) = sum_x;
    reuse(vertex, 1) = sum_y;
    reuse(vertex, 2) = sum_z;
  }
  return reuse;
}

}  // namespace pliant
