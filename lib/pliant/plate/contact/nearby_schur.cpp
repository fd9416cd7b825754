#include "pliant/plate/contact/nearby_schur.hpp"

#include <algorithm>
#include <utility>

namespace pliant {
namespace {

// The part of a matrix in these rows and columns; `places` are those of rows among the rows, -1: in
// none. `is_upper`: of the upper triangle only.
SparseMatrix part_of(const SparseMatrix& matrix, const std::vector<int>& row_places, int row_count,
                     const std::vector<int>& columns, bool is_upper) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t column = 0; column < columns.size(); ++column) {
    for (SparseMatrix::InnerIterator entry(matrix, columns[column]); entry; ++entry) {
      const int row = row_places[static_cast<std::size_t>(entry.row())];
      if (row < 0 || (is_upper && row > static_cast<int>(column))) continue;
      entries.emplace_back(row, static_cast<int>(column), entry.value());
    }
  }
  SparseMatrix part(row_count, static_cast<Eigen::Index>(columns.size()));
  part.setFromTriplets(entries.begin(), entries.end());
  return part;
}

std::vector<int> places_among(const std::vector<int>& unknowns, Eigen::Index size) {
  std::vector<int> places(static_cast<std::size_t>(size), -1);
  for (std::size_t k = 0; k < unknowns.size(); ++k)
    places[static_cast<std::size_t>(unknowns[k])] = static_cast<int>(k);
  return places;
}

// The unknowns to which entries of the matrix lead from some, but for these.
std::vector<int> near(const SparseMatrix& matrix, const std::vector<int>& unknowns, int reach) {
  std::vector<char> is_met(static_cast<std::size_t>(matrix.cols()), 0);
  for (const int unknown : unknowns) is_met[static_cast<std::size_t>(unknown)] = 1;
  std::vector<int> all, last = unknowns;
  for (int layer = 0; layer < reach && !last.empty(); ++layer) {
    std::vector<int> next;
    for (const int unknown : last) {
      for (SparseMatrix::InnerIterator entry(matrix, unknown); entry; ++entry) {
        char& met = is_met[static_cast<std::size_t>(entry.row())];
        if (met == 0) next.push_back(static_cast<int>(entry.row()));
        met = 1;
      }
    }
    all.insert(all.end(), next.begin(), next.end());
    last = std::move(next);
  }
  std::ranges::sort(all);
  return all;
}

}  // namespace

Result<NearbySchur> NearbySchur::make(const SparseMatrix& matrix, const std::vector<int>& unknowns,
                                      int reach, const RunContext& context) {
  NearbySchur made;
  const std::vector<int> others = near(matrix, unknowns, reach);
  const std::vector<int> places = places_among(unknowns, matrix.cols());
  made.own_ = part_of(matrix, places, static_cast<int>(unknowns.size()), unknowns, false);
  if (others.empty()) return made;
  const std::vector<int> other_places = places_among(others, matrix.cols());
  const int count = static_cast<int>(others.size());
  made.across_ = part_of(matrix, other_places, count, unknowns, false);
  made.factor_ = make_sparse_factor(available_solvers().front(), context);
  const SparseMatrix upper = part_of(matrix, other_places, count, others, true);
  if (auto analyzed = made.factor_->analyze(upper); !analyzed) return fail(analyzed.error());
  auto factored = made.factor_->factorize(upper, context.should_stop);
  if (!factored) return fail(factored.error());
  return made;
}

Result<Field> NearbySchur::times(const Field& x) const {
  Field product = Field::Zero(x.rows(), 3), others = Field::Zero(across_.rows(), 3);
  std::vector<int> columns;
  for (int k = 0; k < 3; ++k)
    if (!x.col(k).isZero(0)) columns.push_back(k);
  for (const int k : columns) product.col(k) = own_ * x.col(k);
  if (!factor_) return product;
  for (const int k : columns) others.col(k) = across_ * x.col(k);
  const auto solved = factor_->solve(others);
  if (!solved) return fail(solved.error());
  for (const int k : columns) product.col(k) -= across_.transpose() * solved->col(k);
  return product;
}

}  // namespace pliant
