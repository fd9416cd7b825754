#pragma once

#include <cstddef>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/plate/triangles/cell_block.hpp"

namespace pliant {

/// The elimination of a plate's inner unknowns, kept to eliminate and to recover them often.
/// Forces and displacements (with slopes) are on all unknowns, or on those that are left. Internal
/// to plate.
class InnerUnknowns {
 public:
  /// Unfinished if it is stopped.
  InnerUnknowns(const TriangleCells& cells, const ReducedUnknowns& reduced, const Bending& bending,
                const CellFactors* factors, StopPoll& poll);

  /// Eliminates the inner unknowns from forces on all unknowns; theirs become what `recovered`
  /// needs. The forces on those that are left.
  Field eliminate(Field& forces) const;

  /// All displacements for those that are left, and what `eliminate` made of the forces.
  Field recovered(const Field& left, const Field& eliminated) const;

  std::size_t memory() const;

 private:
  struct Block {
    std::size_t unknown, factor;  // the first of each
    int inner = 0, size = 0;
  };

  std::vector<int> places_;  // of each unknown among those that are left; -1: inner
  int left_ = 0;
  std::vector<Block> blocks_;
  std::vector<int> unknowns_;  // of the blocks, the inner ones of each first

  // Of each inner unknown p: its pivot, then how much of it each later unknown of its block takes.
  std::vector<double> factors_;
};

}  // namespace pliant
