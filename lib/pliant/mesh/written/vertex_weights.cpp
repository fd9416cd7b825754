#include "pliant/mesh/written/vertex_weights.hpp"

#include <utility>

namespace pliant {

Field VertexWeights::apply(const Field& at_nodes, Field reuse) const {
  return *apply(at_nodes, std::move(reuse), {});
}

Result<Field> VertexWeights::apply(const Field& at_nodes, Field reuse,
                                   const StopRequest& should_stop) const {
  Result<Field> at_points;
  if (points) at_points = points->apply(at_nodes, {}, should_stop);
  if (!at_points) return at_points;
  const Field& from = points ? *at_points : at_nodes;
  StopPoll poll(should_stop);
  reuse.resize(vertex_count(), 3);
  const double* const x = from.col(0).data();
  const double* const y = from.col(1).data();
  const double* const z = from.col(2).data();
  for (int vertex = 0; vertex < vertex_count(); ++vertex) {
    if (poll.after(starts[vertex + 1] - starts[vertex] + 1)) return interrupted();
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
