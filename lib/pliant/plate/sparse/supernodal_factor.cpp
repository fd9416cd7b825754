#include "pliant/plate/sparse/supernodal_factor.hpp"

#include <algorithm>

namespace pliant {
namespace {

constexpr long triangle(long columns) { return columns * (columns - 1) / 2; }

// Whether the rows below a column are the next column's own row and the rows below that.
bool continues(const FactorColumns& columns, int column) {
  return columns.counts[column] == columns.counts[column + 1] + 1 &&
         columns.rows[columns.starts[column] + 1] == column + 1;
}

}  // namespace

std::size_t SupernodalFactor::plan(const FactorColumns& columns) {
  supernodes_.clear();
  row_count_ = entry_count_ = 0;
  for (int first = 0; first < columns.size;) {
    int last = first;
    while (last + 1 < columns.size && continues(columns, last)) ++last;
    const int count = last + 1 - first;
    const int below = columns.counts[last] - 1;
    supernodes_.push_back({first, count, below, row_count_, entry_count_});
    row_count_ += below;
    entry_count_ += triangle(count) + long{below} * count;
    first = last + 1;
  }
  const long size = columns.size;
  return sizeof(Supernode) * supernodes_.size() + sizeof(int) * (row_count_ + size) +
         sizeof(double) * (entry_count_ + size + size * row_numbers);
}

void SupernodalFactor::take(const FactorColumns& columns) {
  const int size = columns.size;
  order_.assign(columns.order, columns.order + size);
  pivots_.resize(size);
  rows_.resize(row_count_);
  release();
  entries_ = NumberBlock(entry_count_);
  for (const Supernode& node : supernodes_) {
    const int end = node.first + node.columns;
    int* const rows = rows_.data() + node.rows_at;
    std::copy_n(columns.rows + columns.starts[end - 1] + 1, node.rows, rows);
    double* own = entries_.begin() + node.entries_at;
    double* below = own + triangle(node.columns);
    for (int column = node.first; column < end; ++column) {
      const double* entry = columns.entries + columns.starts[column];
      pivots_[column] = *entry++;
      for (int row = column + 1; row < end; ++row) *own++ = *entry++;
      for (int k = 0; k < node.rows; ++k) below[long{k} * node.columns] = *entry++;
      ++below;
    }
  }
  x_ = NumberBlock(long{size} * row_numbers);
  std::fill_n(x_.begin(), x_.count(), 0.0);
}

Field SupernodalFactor::solve(const Field& right_hand_sides) {
  const auto size = static_cast<int>(order_.size());
  for (int row = 0; row < size; ++row) {
    for (int c = 0; c < 3; ++c) {
      x_.begin()[row * long{row_numbers} + c] = right_hand_sides(order_[row], c);
    }
  }
  kernels_->solve_supernodes({size, static_cast<int>(supernodes_.size()), supernodes_.data(),
                              rows_.data(), entries_.begin(), pivots_.data()},
                             x_.begin());
  Field solution(size, 3);
  for (int row = 0; row < size; ++row) {
    for (int c = 0; c < 3; ++c) {
      solution(order_[row], c) = x_.begin()[row * long{row_numbers} + c];
    }
  }
  return solution;
}

}  // namespace pliant
