#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pliant/plate/outline/outline.hpp"

namespace pliant {

/// The runs of an outline, and its nodes beside the rim, in blocks of rows. The blocks depend on
/// the outline only: results computed block by block, including sums, are bit-identical for any
/// number of threads. Internal to plate.
class RowBlocks {
 public:
  struct Run {
    long first;  ///< node
    long count;
  };
  /// A node beside the rim, and the number of its neighbours along u and along v that are rim.
  struct Edge {
    long node;
    int along_u, along_v;
  };

  RowBlocks() = default;
  explicit RowBlocks(const Outline& outline);

  std::size_t block_count() const { return blocks_.size(); }
  std::span<const Run> runs(std::size_t block) const {
    return std::span(runs_).subspan(blocks_[block].first_run, blocks_[block].run_count);
  }
  std::span<const Edge> edges(std::size_t block) const {
    return std::span(edges_).subspan(blocks_[block].first_edge, blocks_[block].edge_count);
  }

  std::size_t memory() const;  ///< [bytes]

 private:
  struct Block {
    std::size_t first_run, run_count, first_edge, edge_count;
  };

  std::vector<Run> runs_;
  std::vector<Edge> edges_;
  std::vector<Block> blocks_;
};

/// The sum of a[k] b[k], as eight partial sums that are added at the end: an order that allows
/// vector instructions.
class LaneSum {
 public:
  void add(const double* a, const double* b, long count) {
    long k = 0;
    for (; k + lanes <= count; k += lanes) {
      for (int lane = 0; lane < lanes; ++lane) sums_[lane] += a[k + lane] * b[k + lane];
    }
    for (int lane = 0; k < count; ++k, ++lane) sums_[lane] += a[k] * b[k];
  }

  double total() const {
    return ((sums_[0] + sums_[1]) + (sums_[2] + sums_[3])) +
           ((sums_[4] + sums_[5]) + (sums_[6] + sums_[7]));
  }

 private:
  static constexpr int lanes = 8;
  double sums_[lanes] = {};
};

}  // namespace pliant
