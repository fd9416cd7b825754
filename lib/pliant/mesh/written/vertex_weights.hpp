#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant {

/// The size of a mesh that is written from nodes, known before any memory is taken for it.
struct WrittenSize {
  std::int64_t vertices = 0;
  std::int64_t faces = 0;
  std::int64_t weights = 0;  ///< entries of its `VertexWeights`, at most

  static constexpr std::int64_t most_vertices = 100'000'000;
  static constexpr std::int64_t most_faces = 500'000'000;  ///< quads whose corners an int counts
  static constexpr std::int64_t most_weights = 2'000'000'000;
};

/// A linear map from nodes to written vertices: each vertex is a weighted sum of nodes, or of
/// points that are weighted sums of nodes.
struct VertexWeights {
  /// #vertices + 1: the entries of vertex k are starts[k] to starts[k + 1] - 1.
  std::vector<std::size_t> starts = {0};
  std::vector<int> nodes;       ///< #entries
  std::vector<double> weights;  ///< #entries

  /// What the entries name if they name no nodes: the vertices of this map; null: nodes.
  std::shared_ptr<const VertexWeights> points = {};

  int vertex_count() const { return static_cast<int>(starts.size()) - 1; }

  /// The vertices for a value at each node (#nodes x 3 -> #vertices x 3), in the memory of `reuse`.
  /// Each sum runs in the order of its entries. Requires: `at_nodes` has a row for each node named.
  Field apply(const Field& at_nodes, Field reuse = {}) const;

  /// The same. Errors: Interrupted.
  Result<Field> apply(const Field& at_nodes, Field reuse, const StopRequest& should_stop) const;
};

}  // namespace pliant
