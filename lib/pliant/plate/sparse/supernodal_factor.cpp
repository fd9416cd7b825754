#include "pliant/plate/sparse/supernodal_factor.hpp"

#include <algorithm>
#include <utility>

namespace pliant {
namespace {

constexpr long triangle(long columns) { return columns * (columns - 1) / 2; }

// Whether the rows below a column are the next column's own row and the rows below that.
bool continues(const FactorColumns& columns, int column) {
  return columns.counts[column] == columns.counts[column + 1] + 1 &&
         columns.rows[columns.starts[column] + 1] == column + 1;
}

}  // namespace

struct SupernodalFactor::Numbers {
  std::vector<Supernode> supernodes;
  long row_count = 0, entry_count = 0;
  std::vector<int> order;
  std::vector<int> rows;
  NumberBlock entries;
  std::vector<double> pivots;
};

std::size_t SupernodalFactor::plan(const FactorColumns& columns) {
  planned_ = std::make_shared<Numbers>();
  Numbers& numbers = *planned_;
  for (int first = 0; first < columns.size;) {
    int last = first;
    while (last + 1 < columns.size && continues(columns, last)) ++last;
    const int count = last + 1 - first;
    const int below = columns.counts[last] - 1;
    numbers.supernodes.push_back({first, count, below, numbers.row_count, numbers.entry_count});
    numbers.row_count += below;
    numbers.entry_count += triangle(count) + long{below} * count;
    first = last + 1;
  }
  const long size = columns.size;
  return sizeof(Supernode) * numbers.supernodes.size() + sizeof(int) * (numbers.row_count + size) +
         sizeof(double) * (numbers.entry_count + size + size * row_numbers);
}

void SupernodalFactor::take(const FactorColumns& columns) {
  const int size = columns.size;
  Numbers& numbers = *planned_;
  numbers.order.assign(columns.order, columns.order + size);
  numbers.pivots.resize(size);
  numbers.rows.resize(numbers.row_count);
  numbers.entries = NumberBlock(numbers.entry_count);
  for (const Supernode& node : numbers.supernodes) {
    const int end = node.first + node.columns;
    int* const rows = numbers.rows.data() + node.rows_at;
    std::copy_n(columns.rows + columns.starts[end - 1] + 1, node.rows, rows);
    double* own = numbers.entries.begin() + node.entries_at;
    double* below = own + triangle(node.columns);
    for (int column = node.first; column < end; ++column) {
      const double* entry = columns.entries + columns.starts[column];
      numbers.pivots[column] = *entry++;
      for (int row = column + 1; row < end; ++row) *own++ = *entry++;
      for (int k = 0; k < node.rows; ++k) below[long{k} * node.columns] = *entry++;
      ++below;
    }
  }
  use(std::move(planned_));
}

void SupernodalFactor::use(std::shared_ptr<const Numbers> numbers) {
  numbers_ = std::move(numbers);
  x_ = NumberBlock(numbers_->order.size() * row_numbers);
  std::fill_n(x_.begin(), x_.count(), 0.0);
}

Field SupernodalFactor::solve(const Field& right_hand_sides) {
  const Numbers& numbers = *numbers_;
  const std::vector<int>& order = numbers.order;
  const auto size = static_cast<int>(order.size());
  for (int row = 0; row < size; ++row) {
    for (int c = 0; c < 3; ++c) {
      x_.begin()[row * long{row_numbers} + c] = right_hand_sides(order[row], c);
    }
  }
  kernels_->solve_supernodes(
      {size, static_cast<int>(numbers.supernodes.size()), numbers.supernodes.data(),
       numbers.rows.data(), numbers.entries.begin(), numbers.pivots.data()},
      x_.begin());
  Field solution(size, 3);
  for (int row = 0; row < size; ++row) {
    for (int c = 0; c < 3; ++c) {
      solution(order[row], c) = x_.begin()[row * long{row_numbers} + c];
    }
  }
  return solution;
}

}  // namespace pliant
