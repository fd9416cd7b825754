#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <complex>
#include <iterator>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/core/thread_pool.hpp"
#include "pliant/plate/exact/pade.hpp"
#include "pliant/plate/sparse/factored_matrix.hpp"
#include "pliant/plate/sparse/sparse_factor.hpp"
#include "pliant/plate/sparse/supernodal_numbers.hpp"
#include "pliant/plate/sparse/supernode_pattern.hpp"
#include "support/catch.hpp"
#include "support/plates.hpp"
#include "support/sanitized.hpp"

using namespace pliant;
using pliant::testing::assemble_upper;
using pliant::testing::is_sanitized;
using pliant::testing::unit_grid;

namespace {

// The upper triangle of a symmetric matrix that its diagonal makes definite.
SparseMatrix definite(int size, const std::vector<Eigen::Triplet<double>>& upper) {
  Eigen::VectorXd sums = Eigen::VectorXd::Constant(size, 1.0);
  for (const auto& entry : upper) {
    sums[entry.row()] += std::abs(entry.value());
    sums[entry.col()] += std::abs(entry.value());
  }
  std::vector<Eigen::Triplet<double>> all = upper;
  for (int k = 0; k < size; ++k) all.emplace_back(k, k, sums[k]);
  SparseMatrix matrix(size, size);
  matrix.setFromTriplets(all.begin(), all.end());
  return matrix;
}

SparseMatrix random_matrix(int size, int entries, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Eigen::Triplet<double>> upper;
  for (int k = 0; k < entries; ++k) {
    const int a = static_cast<int>(random() % size), b = static_cast<int>(random() % size);
    const int row = std::min(a, b), column = std::max(a, b);
    const double value = static_cast<double>(random() % 2001) / 1000 - 1;
    if (row != column) upper.emplace_back(row, column, value);
  }
  return definite(size, upper);
}

SparseMatrix arrow(int size) {
  std::vector<Eigen::Triplet<double>> upper;
  for (int k = 0; k + 1 < size; ++k) upper.emplace_back(k, size - 1, 0.5);
  return definite(size, upper);
}
SparseMatrix full(int size) {
  std::vector<Eigen::Triplet<double>> upper;
  for (int row = 0; row < size; ++row) {
    for (int column = row + 1; column < size; ++column) {
      upper.emplace_back(row, column, 1.0 / (1 + row + column));
    }
  }
  return definite(size, upper);
}

std::vector<std::pair<std::string, SparseMatrix>> matrices() {
  std::vector<std::pair<std::string, SparseMatrix>> result = {
      {"one row", definite(1, {})},
      {"a diagonal", definite(9, {})},
      {"an arrow", arrow(20)},
      {"a plate",
       assemble_upper({is_sanitized ? unit_grid(16, 12) : unit_grid(40, 30), {1, 2, 1}, 0})},
  };
  // One supernode of each count of columns that is done at once, and of what is left over.
  for (int size = 2; size <= 20; ++size) {
    result.emplace_back(fmt::format("a full one of {}", size), full(size));
  }
  for (unsigned seed = 0; seed < 20; ++seed) {
    const int size = 5 + static_cast<int>(seed) * 13;
    result.emplace_back(fmt::format("a random one, seed {}", seed),
                        random_matrix(size, size * (1 + static_cast<int>(seed) % 4), seed));
  }
  return result;
}

// A slow factor L D L^T in the order of the rows, in extended precision, and what it solves.
Field solved_slowly(const SparseMatrix& upper, const Field& right_hand_sides) {
  using Real = long double;
  using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  Matrix a = SparseMatrix(upper.selfadjointView<Eigen::Upper>()).toDense().cast<Real>();
  Matrix x = right_hand_sides.cast<Real>();
  for (Eigen::Index k = 0; k < a.rows(); ++k) {
    for (Eigen::Index row = k + 1; row < a.rows(); ++row) {
      const Real share = a(row, k) / a(k, k);
      a.row(row).tail(a.cols() - k) -= share * a.row(k).tail(a.cols() - k);
      x.row(row) -= share * x.row(k);
    }
  }
  for (Eigen::Index k = a.rows() - 1; k >= 0; --k) {
    for (Eigen::Index later = k + 1; later < a.rows(); ++later)
      x.row(k) -= a(k, later) * x.row(later);
    x.row(k) /= a(k, k);
  }
  return x.cast<double>();
}

// The entries of L below its diagonal, by columns, found one column after another.
std::vector<std::set<int>> columns_of_factor(const SparseMatrix& upper,
                                             const std::vector<int>& order) {
  std::vector<int> places(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) places[order[k]] = static_cast<int>(k);
  std::vector<std::set<int>> columns(order.size());
  for (int column = 0; column < upper.cols(); ++column) {
    for (SparseMatrix::InnerIterator entry(upper, column); entry; ++entry) {
      const auto [low, high] = std::minmax(places[entry.row()], places[column]);
      if (low != high) columns[low].insert(high);
    }
  }
  for (auto& rows : columns) {
    if (rows.empty()) continue;
    const int parent = *rows.begin();
    columns[parent].insert(std::next(rows.begin()), rows.end());
  }
  return columns;
}

Result<void> factored(const SparseMatrix& matrix, const StopRequest& should_stop = {}) {
  const auto factor = make_supernodal_factor({});
  if (auto analyzed = factor->analyze(matrix); !analyzed) return analyzed;
  return factor->factorize(matrix, should_stop);
}

}  // namespace

TEST_CASE("supernodes have all entries of the factor, and few others", "[plate][factor]") {
  for (const auto& [name, matrix] : matrices()) {
    CAPTURE(name);
    const SupernodePattern pattern(matrix);
    std::vector<int> order = pattern.order();
    const auto columns = columns_of_factor(matrix, order);
    std::sort(order.begin(), order.end());
    for (int k = 0; k < pattern.size(); ++k) REQUIRE(order[k] == k);
    long needed = 0;
    int next = 0;
    for (std::size_t k = 0; k < pattern.supernodes().size(); ++k) {
      const Supernode& node = pattern.supernodes()[k];
      REQUIRE(node.first == next);
      next += node.columns;
      const auto below = pattern.rows_below(node);
      CHECK(std::is_sorted(below.begin(), below.end()));
      for (int column = node.first; column < next; ++column) {
        needed += static_cast<long>(columns[column].size());
        for (const int row : columns[column])
          CHECK((row < next || std::binary_search(below.begin(), below.end(), row)));
      }
      const int parent = pattern.parents()[k];
      REQUIRE((parent < 0) == below.empty());
      if (parent < 0) continue;
      const Supernode& above = pattern.supernodes()[parent];
      CHECK(below.front() >= above.first);
      CHECK(below.front() < above.first + above.columns);
    }
    CHECK(next == pattern.size());
    CHECK(pattern.entry_count() >= needed);
    CHECK(2 * pattern.entry_count() <= 5 * needed);
  }
}

TEST_CASE("supernodes solve what a slow factor solves, with the same bits for every width",
          "[plate][factor]") {
  for (const auto& [name, matrix] : matrices()) {
    CAPTURE(name);
    const Field forces = Field::Random(matrix.rows(), 3);
    const Field expected = solved_slowly(matrix, forces);
    Field first;
    for (int k = 0; const PlateKernels* kernels = runnable_kernels(k); ++k) {
      CAPTURE(kernels->name);
      const auto factor = make_supernodal_factor({.most_lanes = kernels->lanes});
      REQUIRE(factor->analyze(matrix));
      REQUIRE(factor->factorize(matrix, {}));
      const Field found = factor->solve(forces).value();
      // A static plate loses digits.
      const double error = name == "a plate" ? 1e-11 : 1e-13;
      CHECK((found - expected).cwiseAbs().maxCoeff() <= error * expected.cwiseAbs().maxCoeff());
      CHECK(factor->solve(forces).value() == found);
      if (k == 0) first = found;
      CHECK(found == first);
    }
  }
}

TEST_CASE("a complex factor solves what a full matrix solves, with the same bits for every width",
          "[plate][factor][exact]") {
  using Number = std::complex<double>;
  for (const auto& [name, matrix] : matrices()) {
    CAPTURE(name);
    const auto size = matrix.rows();
    const auto pattern = std::make_shared<const SupernodePattern>(matrix);
    Eigen::MatrixXcd full =
        SparseMatrix(matrix.selfadjointView<Eigen::Upper>()).toDense().cast<Number>();
    // Of half the rows, as far from the positive numbers as they may be, and farther.
    std::vector<Complex> shifts;
    for (Eigen::Index row = 0; row < (size + 1) / 2; ++row) {
      const double share = static_cast<double>(row + 1) / static_cast<double>(size);
      shifts.push_back({0.5 - 2 * share, 3 * share});
      full(row, row) += Number(shifts.back().re, shifts.back().im);
    }
    const Eigen::MatrixXcd forces = Eigen::MatrixXcd::Random(size, 3);
    const Eigen::MatrixXcd expected = full.fullPivLu().solve(forces);
    Eigen::MatrixXcd first;
    for (int k = 0; const PlateKernels* kernels = runnable_kernels(k); ++k) {
      const RunContext context{.most_lanes = kernels->lanes};
      SupernodalNumbers<Complex> factor;
      REQUIRE(factor.factorize(pattern, matrix.valuePtr(), shifts, context));
      constexpr int line = SupernodalNumbers<Complex>::line;
      const NumberBlock x(static_cast<std::size_t>(pattern->solve_size() * line));
      std::fill_n(x.begin(), x.count(), 0.0);
      const auto at = [&](int place, int c) { return x.begin() + place * line + c; };
      for (int place = 0; place < size; ++place) {
        for (int c = 0; c < 3; ++c) {
          const Number force = forces(pattern->order()[place], c);
          *at(place, c) = force.real();
          *at(place, line / 2 + c) = force.imag();
        }
      }
      factor.solve(context, x.begin());
      Eigen::MatrixXcd found(size, 3);
      for (int place = 0; place < size; ++place) {
        for (int c = 0; c < 3; ++c)
          found(pattern->order()[place], c) = Number(*at(place, c), *at(place, line / 2 + c));
      }
      const double error = name == "a plate" ? 1e-10 : 1e-12;
      CHECK((found - expected).norm() <= error * expected.norm());
      if (k == 0) first = found;
      CHECK(found == first);
    }
  }
}

TEST_CASE("a complex factor without a pivot is refused", "[plate][factor][exact]") {
  SparseMatrix matrix(2, 2);
  const std::vector<Eigen::Triplet<double>> entries = {{0, 0, 0}, {0, 1, 0}, {1, 1, 1}};
  matrix.setFromTriplets(entries.begin(), entries.end());
  const auto pattern = std::make_shared<const SupernodePattern>(matrix);
  const double none = std::numeric_limits<double>::quiet_NaN();
  for (const Complex shift : {Complex{}, Complex{none, 1}, Complex{1, none}, Complex{1e160, 0}}) {
    SupernodalNumbers<Complex> factor;
    const auto made = factor.factorize(pattern, matrix.valuePtr(), std::array{shift}, {});
    REQUIRE_FALSE(made);
    CHECK(made.error().code == ErrorCode::SolverFailed);
  }
  SupernodalNumbers<Complex> factor;
  CHECK(factor.factorize(pattern, matrix.valuePtr(), std::array{Complex{0, 1}}, {}));
}

TEST_CASE("no bit of a factor depends on threads, nor do its errors", "[plate][factor][threads]") {
  SparseMatrix matrix = assemble_upper({unit_grid(140, 120), {1, 2, 1}, 0});
  const SupernodePattern pattern(matrix);
  REQUIRE(pattern.subtrees().size() >= 4);
  REQUIRE(pattern.above_subtrees().size() >= 2);
  const Field forces = Field::Random(matrix.rows(), 3);
  const auto alone = make_supernodal_factor({});
  REQUIRE(alone->analyze(matrix));
  REQUIRE(alone->factorize(matrix, {}));
  const Field expected = alone->solve(forces).value();
  ThreadPool threads(4);
  const auto factor = make_supernodal_factor({.threads = &threads});
  REQUIRE(factor->analyze(matrix));
  for (int k = 0; k < 3; ++k) {
    REQUIRE(factor->factorize(matrix, {}));
    CHECK(factor->solve(forces).value() == expected);
  }
  std::atomic<int> asked = 0;
  const auto stopped = factor->factorize(matrix, [&] { return ++asked >= 1; });
  if (!stopped) CHECK(stopped.error().code == ErrorCode::Interrupted);
  for (const Eigen::Index place : {Eigen::Index{0}, matrix.rows() / 2, matrix.rows() - 1}) {
    SparseMatrix indefinite = matrix;
    indefinite.coeffRef(place, place) = -1;
    const auto one = alone->factorize(indefinite, {}), other = factor->factorize(indefinite, {});
    REQUIRE_FALSE(one);
    REQUIRE_FALSE(other);
    CHECK(one.error().message == other.error().message);
  }
}

TEST_CASE("a matrix that is not positive definite is refused at once", "[plate][factor]") {
  const auto with = [](int place, double value) {
    SparseMatrix matrix = random_matrix(60, 150, 3);
    matrix.coeffRef(place, place) = value;
    return matrix;
  };
  const double none = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double value : {-1.0, 0.0, -0.0, none, infinite, -infinite}) {
    for (const int place : {0, 31, 59}) {
      CAPTURE(value, place);
      const auto made = factored(with(place, value));
      REQUIRE_FALSE(made);
      CHECK(made.error().code == ErrorCode::SolverFailed);
    }
  }
  // Singular: the rows of a graph without a held node.
  SparseMatrix chain(3, 3);
  std::vector<Eigen::Triplet<double>> entries = {
      {0, 0, 1}, {0, 1, -1}, {1, 1, 2}, {1, 2, -1}, {2, 2, 1}};
  chain.setFromTriplets(entries.begin(), entries.end());
  const auto made = factored(chain);
  REQUIRE_FALSE(made);
  CHECK(made.error().code == ErrorCode::SolverFailed);
}

TEST_CASE("the scale of a matrix does not matter to its factor", "[plate][factor]") {
  const SparseMatrix matrix = random_matrix(90, 250, 5);
  const Field forces = Field::Random(matrix.rows(), 3);
  const auto solution_of = [&](const SparseMatrix& one) {
    const auto factor = make_supernodal_factor({});
    REQUIRE(factor->analyze(one));
    REQUIRE(factor->factorize(one, {}));
    return factor->solve(forces).value();
  };
  const Field expected = solution_of(matrix);
  for (const int power : {-900, -30, 30, 900}) {
    CAPTURE(power);
    const double scale = std::ldexp(1, power);
    CHECK(solution_of(matrix * scale) * scale == expected);
  }
}

TEST_CASE("a factor is stopped within its supernodes", "[plate][factor][stop]") {
  const SparseMatrix matrix = full(is_sanitized ? 300 : 900);
  int asked = 0;
  REQUIRE(factored(matrix, [&] { return ++asked < 0; }));
  CHECK(asked > (is_sanitized ? 0 : 10));
  for (const int moment : {1, asked / 2, asked}) {
    int now = 0;
    const auto made = factored(matrix, [&] { return ++now >= moment; });
    REQUIRE_FALSE(made);
    CHECK(made.error().code == ErrorCode::Interrupted);
    CHECK(now == moment);
  }
}

TEST_CASE("a factor reserves what making it takes, then what remains", "[plate][factor]") {
  const SparseMatrix matrix = assemble_upper({unit_grid(60, 60), {1, 2, 1}, 0});
  const auto probe = make_supernodal_factor({});
  REQUIRE(probe->analyze(matrix));
  FactoredMatrix plain(SolverChoice::Supernodal, {});
  REQUIRE(plain.factor(matrix, false));
  const auto with_budget = [&](std::size_t bytes, const auto& check) {
    MemoryBudget budget(bytes);
    FactoredMatrix factor(SolverChoice::Supernodal, {.memory = &budget});
    check(factor);
  };
  const std::size_t most = plain.memory() + probe->work_bytes();
  with_budget(most - 1, [&](FactoredMatrix& factor) {
    const auto made = factor.factor(matrix, false);
    REQUIRE_FALSE(made);
    CHECK(made.error().code == ErrorCode::OutOfMemory);
  });
  with_budget(most, [&](FactoredMatrix& factor) {
    REQUIRE(factor.factor(matrix, false));
    CHECK(factor.memory() == plain.memory());
    REQUIRE(factor.factor(matrix, true));
    CHECK(factor.solve(Field::Random(matrix.rows(), 3)));
  });
}
