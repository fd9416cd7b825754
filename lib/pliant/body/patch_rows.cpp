#include "pliant/body/patch_rows.hpp"

namespace pliant {
namespace {

// Calls f(component, first, count) for the nodes outside of runs.
template <class F>
void for_stretches_around(std::span<const RowRun> hole, Eigen::Index node_count, const F& f) {
  for (int component = 0; component < 3; ++component) {
    Eigen::Index first = 0;
    for (const RowRun& run : hole) {
      f(component, first, run.node - first);
      first = run.node + run.count;
    }
    f(component, first, node_count - first);
  }
}

// NaN if a number is not finite, else 0.
template <class Numbers>
double unsoundness(const Numbers& numbers) {
  return (numbers - numbers).sum();  // NOLINT(misc-redundant-expression): 0 only if finite
}

}  // namespace

void take_difference(std::span<const RowRun> runs, const Field& a, const Field& b, Field& rows) {
  for (int k = 0; k < 3; ++k) {
    for (const RowRun& run : runs) {
      rows.col(k).segment(run.row, run.count) =
          a.col(k).segment(run.node, run.count) - b.col(k).segment(run.node, run.count);
    }
  }
}

bool put_motion(std::span<const RowRun> runs, const PlateState& state, const Field* reference,
                Field& positions, Field& velocities) {
  double unsound = 0;
  for (int k = 0; k < 3; ++k) {
    for (const RowRun& run : runs) {
      auto position = positions.col(k).segment(run.node, run.count);
      auto velocity = velocities.col(k).segment(run.node, run.count);
      const auto moved = state.displacement.col(k).segment(run.row, run.count);
      if (reference) {
        position = reference->col(k).segment(run.node, run.count) + moved;
      } else {
        position = moved;
      }
      velocity = state.velocity.col(k).segment(run.row, run.count);
      unsound += unsoundness(position) + unsoundness(velocity);
    }
  }
  return unsound == 0;
}

void copy_around(std::span<const RowRun> hole, const Field& from, Field& to) {
  to.resize(from.rows(), 3);
  for_stretches_around(hole, from.rows(), [&](int k, Eigen::Index first, Eigen::Index count) {
    to.col(k).segment(first, count) = from.col(k).segment(first, count);
  });
}

void clear_around(std::span<const RowRun> hole, Eigen::Index node_count, Field& nodes) {
  nodes.resize(node_count, 3);
  for_stretches_around(hole, node_count, [&](int k, Eigen::Index first, Eigen::Index count) {
    nodes.col(k).segment(first, count).setZero();
  });
}

}  // namespace pliant
