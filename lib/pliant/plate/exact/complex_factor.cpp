#include "pliant/plate/exact/complex_factor.hpp"

#include <algorithm>
#include <numeric>

#include <Eigen/OrderingMethods>

#include "pliant/plate/solver_errors.hpp"

namespace pliant {

FactorPattern::FactorPattern(const SparseMatrix& upper) {
  const auto size = static_cast<int>(upper.cols());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(upper.selfadjointView<Eigen::Upper>(), order);
  order_.assign(order.indices().data(), order.indices().data() + size);
  std::vector<int> places(order_.size());
  for (int k = 0; k < size; ++k) places[order_[k]] = k;

  own_starts_.assign(order_.size() + 1, 0);
  const auto for_each_entry = [&](const auto& f) {
    for (int column = 0; column < size; ++column) {
      for (int k = upper.outerIndexPtr()[column]; k < upper.outerIndexPtr()[column + 1]; ++k) {
        const auto [low, high] = std::minmax(places[upper.innerIndexPtr()[k]], places[column]);
        f(k, low, high);
      }
    }
  };
  for_each_entry([&](int, int, int high) { ++own_starts_[high + 1]; });
  std::partial_sum(own_starts_.begin(), own_starts_.end(), own_starts_.begin());
  own_rows_.resize(static_cast<std::size_t>(upper.nonZeros()));
  own_places_.resize(own_rows_.size());
  std::vector<int> next(own_starts_.begin(), own_starts_.end() - 1);
  for_each_entry([&](int k, int low, int high) {
    own_rows_[next[high]] = low;
    own_places_[next[high]++] = k;
  });

  parents_.assign(order_.size(), -1);
  std::vector<int> seen(order_.size(), -1);
  starts_.assign(order_.size() + 1, 0);
  for (int row = 0; row < size; ++row) {
    seen[row] = row;
    for (int k = own_starts_[row]; k < own_starts_[row + 1]; ++k) {
      for (int column = own_rows_[k]; seen[column] != row; column = parents_[column]) {
        if (parents_[column] < 0) parents_[column] = row;
        seen[column] = row;
        ++starts_[column + 1];
      }
    }
  }
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
}

void FactorPattern::store_entries() {
  rows_.resize(starts_.back());
  std::vector<std::size_t> ends(starts_.begin(), starts_.end() - 1);
  std::vector<int> seen(order_.size(), -1);
  for (int row = 0; row < size(); ++row) {
    seen[row] = row;
    for (int k = own_starts_[row]; k < own_starts_[row + 1]; ++k) {
      for (int column = own_rows_[k]; seen[column] != row; column = parents_[column]) {
        seen[column] = row;
        rows_[ends[column]++] = row;
      }
    }
  }
}

std::size_t FactorPattern::memory() const {
  return entries() * sizeof(int) + own_rows_.size() * 2 * sizeof(int) +
         order_.size() * (3 * sizeof(int) + sizeof(std::size_t));
}

std::size_t ComplexFactor::memory(const FactorPattern& pattern) {
  return (pattern.entries() + static_cast<std::size_t>(pattern.size())) * sizeof(Complex);
}

// Row by row: each row of L is solved from the rows before it.
Result<void> ComplexFactor::factorize(const FactorPattern& pattern, const SparseMatrix& upper,
                                      std::span<const Complex> shifts,
                                      const StopRequest& should_stop) {
  const int size = pattern.size();
  entries_.resize(pattern.entries());
  pivots_.resize(static_cast<std::size_t>(size));
  std::vector<std::size_t> ends(pattern.starts_.begin(), pattern.starts_.end() - 1);
  std::vector<Complex> row_values(static_cast<std::size_t>(size));
  std::vector<int> seen(static_cast<std::size_t>(size), -1), path(seen), stack(seen);
  StopPoll poll(should_stop);
  for (int row = 0; row < size; ++row) {
    if (poll.after(64)) return interrupted();
    seen[row] = row;
    int top = size;
    for (int k = pattern.own_starts_[row]; k < pattern.own_starts_[row + 1]; ++k) {
      row_values[pattern.own_rows_[k]].re += upper.valuePtr()[pattern.own_places_[k]];
      int length = 0;
      for (int column = pattern.own_rows_[k]; seen[column] != row;
           column = pattern.parents_[column]) {
        path[length++] = column;
        seen[column] = row;
      }
      while (length > 0) stack[--top] = path[--length];
    }
    const auto shift = static_cast<std::size_t>(pattern.order_[row]);
    Complex pivot = row_values[row] + (shift < shifts.size() ? shifts[shift] : Complex{});
    row_values[row] = {};
    for (; top < size; ++top) {
      const int column = stack[top];
      const Complex value = row_values[column];
      row_values[column] = {};
      if (poll.after(ends[column] - pattern.starts_[column])) return interrupted();
      for (std::size_t k = pattern.starts_[column]; k < ends[column]; ++k) {
        Complex& target = row_values[pattern.rows_[k]];
        target = target - entries_[k] * value;
      }
      const Complex entry = value * pivots_[column];
      pivot = pivot - entry * value;
      entries_[ends[column]++] = entry;
    }
    const double square = pivot.re * pivot.re + pivot.im * pivot.im;
    if (!(square > 0) || !(square < 1e300)) return fail(not_positive_definite(size, row));
    pivots_[row] = reciprocal(pivot);
  }
  return {};
}

void ComplexFactor::solve(const FactorPattern& pattern, double* x) const {
  constexpr int half = row_numbers / 2;
  const int size = pattern.size();
  for (int column = 0; column < size; ++column) {
    const double* const from = x + long{column} * row_numbers;
    for (std::size_t k = pattern.starts_[column]; k < pattern.starts_[column + 1]; ++k) {
      const auto [re, im] = entries_[k];
      double* const to = x + long{pattern.rows_[k]} * row_numbers;
      for (int c = 0; c < half; ++c) {
        to[c] -= re * from[c] - im * from[half + c];
        to[half + c] -= re * from[half + c] + im * from[c];
      }
    }
  }
  for (int column = size - 1; column >= 0; --column) {
    double* const to = x + long{column} * row_numbers;
    const auto [pivot_re, pivot_im] = pivots_[column];
    double sum[row_numbers];
    for (int c = 0; c < half; ++c) {
      sum[c] = pivot_re * to[c] - pivot_im * to[half + c];
      sum[half + c] = pivot_re * to[half + c] + pivot_im * to[c];
    }
    for (std::size_t k = pattern.starts_[column]; k < pattern.starts_[column + 1]; ++k) {
      const auto [re, im] = entries_[k];
      const double* const from = x + long{pattern.rows_[k]} * row_numbers;
      for (int c = 0; c < half; ++c) {
        sum[c] -= re * from[c] - im * from[half + c];
        sum[half + c] -= re * from[half + c] + im * from[c];
      }
    }
    for (int c = 0; c < row_numbers; ++c) to[c] = sum[c];
  }
}

}  // namespace pliant
