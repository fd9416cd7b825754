#pragma once

#include <algorithm>
#include <array>

#include "pliant/plate/sparse/sparse_factor.hpp"

namespace pliant {

/// The entries of a column of the upper triangle, by ascending row. In a narrow ring several
/// neighbours of a node are the same node; their weights add up. Internal to plate.
class UpperColumn {
 public:
  void add(int row, double weight) {
    int place = count_;
    while (place > 0 && entries_[place - 1].row >= row) --place;
    if (place < count_ && entries_[place].row == row) {
      entries_[place].weight += weight;
      return;
    }
    std::copy_backward(entries_.begin() + place, entries_.begin() + count_,
                       entries_.begin() + count_ + 1);
    entries_[place] = {row, weight};
    ++count_;
  }

  void insert_into(SparseMatrix& matrix, int column) const {
    matrix.startVec(column);
    for (int k = 0; k < count_; ++k)
      matrix.insertBack(entries_[k].row, column) = entries_[k].weight;
  }

 private:
  struct Entry {
    int row;
    double weight;
  };

  std::array<Entry, 13> entries_;
  int count_ = 0;
};

}  // namespace pliant
