#pragma once

#include <span>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/plate/plate.hpp"

namespace pliant {

// Copies between fields of a body and fields of a patch. Internal to body.

/// Rows of a patch's fields, side by side, that are those of nodes (or triangles) side by side.
struct RowRun {
  int node, row, count;
};

/// Adds a row after others; as part of the last run, if it goes on.
inline void add_row(std::vector<RowRun>& runs, int node, int row) {
  if (!runs.empty() && runs.back().node + runs.back().count == node &&
      runs.back().row + runs.back().count == row) {
    ++runs.back().count;
  } else {
    runs.push_back({node, row, 1});
  }
}

/// Copies the rows of nodes. `rows` has its size.
template <class Rows>
void take_rows(std::span<const RowRun> runs, const Rows& nodes, Rows& rows) {
  for (int k = 0; k < Rows::ColsAtCompileTime; ++k) {
    for (const RowRun& run : runs)
      rows.col(k).segment(run.row, run.count) = nodes.col(k).segment(run.node, run.count);
  }
}

/// Copies rows to nodes.
template <class Rows>
void put_rows(std::span<const RowRun> runs, const Rows& rows, Rows& nodes) {
  for (int k = 0; k < Rows::ColsAtCompileTime; ++k) {
    for (const RowRun& run : runs)
      nodes.col(k).segment(run.node, run.count) = rows.col(k).segment(run.row, run.count);
  }
}

/// Copies the rows of a - b.
void take_difference(std::span<const RowRun> runs, const Field& a, const Field& b, Field& rows);

/// Writes displacement and velocity to the positions and velocities of nodes. `reference` is added
/// to the positions; null: nothing is. Returns whether all numbers are finite; if not, the fields
/// may be partly written.
bool put_motion(std::span<const RowRun> runs, const PlateState& state, const Field* reference,
                Field& positions, Field& velocities);

/// Copies (sets to 0) all nodes but those of the runs, whose nodes ascend.
void copy_around(std::span<const RowRun> hole, const Field& from, Field& to);
void clear_around(std::span<const RowRun> hole, Eigen::Index node_count, Field& nodes);

}  // namespace pliant
