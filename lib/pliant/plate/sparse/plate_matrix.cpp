#include "pliant/plate/sparse/plate_matrix.hpp"

#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/plate/solver_errors.hpp"

namespace pliant {
namespace {

// The numbers of `keys` (each below `count`) in ascending order of their key; equal keys keep that
// of `order`.
std::vector<int> sorted_by(const std::vector<int>& keys, int count, const std::vector<int>& order) {
  std::vector<int> next(static_cast<std::size_t>(count) + 1, 0);
  for (const int key : keys) ++next[key + 1];
  for (int key = 0; key < count; ++key) next[key + 1] += next[key];
  std::vector<int> sorted(keys.size());
  for (const int number : order) sorted[next[keys[number]]++] = number;
  return sorted;
}

}  // namespace

Result<void> PlateMatrix::take(std::size_t bytes) {
  if (share_.try_resize(bytes)) return {};
  return fail(factor_too_large(assembly_->size(), share_.complaint(bytes)));
}

std::size_t PlateMatrix::kept_bytes() const {
  return static_cast<std::size_t>(stiffness_.nonZeros()) * (sizeof(double) + sizeof(int)) +
         places_.size() * sizeof(int) + static_cast<std::size_t>(goals_.size()) * sizeof(double);
}

// Sums entries in the order of the assembly.
Result<void> PlateMatrix::assemble(const PlateAssembly& assembly) {
  // Entries, their order before and after it is sorted, their places, and the matrix twice.
  constexpr std::size_t bytes_of_entry =
      sizeof(double) + 2 * sizeof(int) + 3 * sizeof(int) + 2 * (sizeof(double) + sizeof(int));
  assembly_ = &assembly;
  close();
  if (auto taken = take(kept_bytes() + assembly.most_entries() * bytes_of_entry); !taken)
    return taken;
  const auto made = assembly.entries();
  if (!made) return fail(made.error());
  const auto& [rows, columns, values] = *made;
  const int size = assembly.size();
  std::vector<int> order(rows.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<int>(k);
  order = sorted_by(rows, size, order);
  if (context_.is_stopped()) return interrupted();
  order = sorted_by(columns, size, order);
  if (context_.is_stopped()) return interrupted();
  std::vector<int> starts = {0}, inner;
  std::vector<double> sums;
  places_.resize(rows.size());
  for (const int number : order) {
    while (static_cast<int>(starts.size()) <= columns[number])
      starts.push_back(static_cast<int>(inner.size()));
    const bool is_first =
        starts.back() == static_cast<int>(inner.size()) || inner.back() != rows[number];
    if (is_first) {
      inner.push_back(rows[number]);
      sums.push_back(0);
    }
    sums.back() += values[number];
    places_[number] = static_cast<int>(inner.size()) - 1;
  }
  while (static_cast<int>(starts.size()) <= size) starts.push_back(static_cast<int>(inner.size()));
  const auto is_same = [](const std::vector<int>& one, const int* other, Eigen::Index count) {
    return static_cast<Eigen::Index>(one.size()) == count &&
           std::equal(one.begin(), one.end(), other);
  };
  keeps_pattern_ = stiffness_.cols() == size &&
                   is_same(starts, stiffness_.outerIndexPtr(), size + 1) &&
                   is_same(inner, stiffness_.innerIndexPtr(), stiffness_.nonZeros());
  stiffness_ = Eigen::Map<const SparseMatrix>(size, size, static_cast<Eigen::Index>(inner.size()),
                                              starts.data(), inner.data(), sums.data());
  goals_ = assembly.goals();
  for (Eigen::Index k = 0; k < goals_.size(); ++k)
    stiffness_.valuePtr()[place_on_diagonal(k)] += goals_[k];
  return take(kept_bytes());
}

// It is the last of each column.
std::size_t PlateMatrix::place_on_diagonal(Eigen::Index column) const {
  return static_cast<std::size_t>(stiffness_.outerIndexPtr()[column + 1]) - 1;
}

SparseMatrix PlateMatrix::shifted(const Eigen::VectorXd& shifts) const {
  SparseMatrix sum = stiffness_;
  for (Eigen::Index k = 0; k < shifts.size(); ++k)
    sum.valuePtr()[place_on_diagonal(k)] += shifts[k];
  return sum;
}

Result<void> PlateMatrix::open() {
  if (assembly_->differences()) return {};
  const auto count = static_cast<std::size_t>(stiffness_.nonZeros());
  const std::size_t kept = kept_bytes() + 2 * count * (sizeof(Extended) + sizeof(int));
  const std::size_t entries = places_.size() * (sizeof(Extended) + 2 * sizeof(int));
  if (auto taken = take(kept + entries + count * sizeof(Extended)); !taken) return taken;
  std::vector<Extended> sums(count, 0);
  {
    const auto made = assembly_->precise_entries();
    if (!made) return fail(made.error());
    PLIANT_EXPECTS(made->values.size() == places_.size());
    for (std::size_t k = 0; k < places_.size(); ++k) sums[places_[k]] += made->values[k];
    for (Eigen::Index k = 0; k < goals_.size(); ++k) sums[place_on_diagonal(k)] += goals_[k];
  }
  const auto size = static_cast<std::size_t>(stiffness_.cols());
  const int* const starts = stiffness_.outerIndexPtr();
  const int* const rows = stiffness_.innerIndexPtr();
  precise_.starts.assign(size + 1, 0);
  for (std::size_t column = 0; column < size; ++column) {
    for (int k = starts[column]; k < starts[column + 1]; ++k) {
      ++precise_.starts[rows[k] + 1];
      if (rows[k] != static_cast<int>(column)) ++precise_.starts[column + 1];
    }
  }
  for (std::size_t row = 0; row < size; ++row) precise_.starts[row + 1] += precise_.starts[row];
  precise_.columns.resize(precise_.starts.back());
  precise_.values.resize(precise_.starts.back());
  std::vector<std::size_t> next(precise_.starts.begin(), precise_.starts.end() - 1);
  const auto put = [&](int row, int column, Extended value) {
    precise_.columns[next[row]] = column;
    precise_.values[next[row]++] = value;
  };
  // A row's own column comes first, then those after it.
  for (int column = 0; column < static_cast<int>(size); ++column) {
    for (int k = starts[column]; k < starts[column + 1]; ++k) {
      put(column, rows[k], sums[k]);
      if (rows[k] != column) put(rows[k], column, sums[k]);
    }
  }
  return take(kept);
}

void PlateMatrix::close() {
  precise_ = {};
  static_cast<void>(share_.try_resize(kept_bytes()));  // to give back never fails
}

Field PlateMatrix::residual(const Eigen::VectorXd& shifts, const Field& x, const Field& f) const {
  if (const auto* own = assembly_->differences()) {
    return own->residual(goals_.size() > 0 ? Eigen::VectorXd(shifts + goals_) : shifts, x, f);
  }
  PLIANT_EXPECTS(static_cast<Eigen::Index>(precise_.starts.size()) == x.rows() + 1);
  const double* const of_x = x.col(0).data();
  const double* const of_y = x.col(1).data();
  const double* const of_z = x.col(2).data();
  Field result(f.rows(), 3);
  for (Eigen::Index row = 0; row < result.rows(); ++row) {
    const Extended shift = row < shifts.size() ? shifts[row] : 0;
    Extended left_x = f(row, 0) - shift * of_x[row];
    Extended left_y = f(row, 1) - shift * of_y[row];
    Extended left_z = f(row, 2) - shift * of_z[row];
    for (std::size_t k = precise_.starts[row]; k < precise_.starts[row + 1]; ++k) {
      const Extended entry = precise_.values[k];
      const int column = precise_.columns[k];
      left_x -= entry * of_x[column];
      left_y -= entry * of_y[column];
      left_z -= entry * of_z[column];
    }
    result(row, 0) = static_cast<double>(left_x);
    result(row, 1) = static_cast<double>(left_y);
    result(row, 2) = static_cast<double>(left_z);
  }
  return result;
}

}  // namespace pliant
