#include "pliant/plate/sparse/supernodal_factor.hpp"

#include <algorithm>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/plate/sparse/factored_matrix.hpp"
#include "pliant/plate/sparse/operator.hpp"
#include "support/catch.hpp"
#include "support/plates.hpp"

using namespace pliant;
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
      {"a plate", assemble_upper({unit_grid(40, 30), {1, 2, 1}, 0})},
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

}  // namespace

TEST_CASE("supernodes solve what their library's factor solves, with the same bits for every width",
          "[plate][factor]") {
  const auto factor = make_sparse_factor(available_solvers().front());
  for (const auto& [name, matrix] : matrices()) {
    CAPTURE(name);
    REQUIRE(factor->analyze(matrix));
    REQUIRE(factor->factorize(matrix, {}));
    const Field forces = Field::Random(matrix.rows(), 3);
    const Field expected = factor->solve(forces).value();
    const auto columns = factor->columns();
    if (!columns) return;  // Eigen
    Field first;
    for (int k = 0; const PlateKernels* kernels = runnable_kernels(k); ++k) {
      CAPTURE(kernels->name);
      SupernodalFactor supernodes(*kernels);
      supernodes.plan(*columns);
      supernodes.take(*columns);
      const Field found = supernodes.solve(forces);
      CHECK((found - expected).cwiseAbs().maxCoeff() <= 1e-13 * expected.cwiseAbs().maxCoeff());
      CHECK(supernodes.solve(forces) == found);
      if (k == 0) first = found;
      CHECK(found == first);
    }
  }
}

TEST_CASE("a factor in supernodes reserves what the copy takes, then what remains",
          "[plate][factor]") {
  const SparseMatrix matrix = assemble_upper({unit_grid(60, 60), {1, 2, 1}, 0});
  const SolverChoice choice = available_solvers().front();
  const auto assemble = [&] { return matrix; };
  FactoredMatrix plain(choice, {});
  REQUIRE(plain.factor(matrix.rows(), false, assemble));
  const auto probe = make_sparse_factor(choice);
  REQUIRE(probe->analyze(matrix));
  REQUIRE(probe->factorize(matrix, {}));
  if (!probe->columns()) return;  // Eigen

  const auto with_budget = [&](std::size_t bytes, const auto& check) {
    MemoryBudget budget(bytes);
    RunContext context;
    context.memory = &budget;
    FactoredMatrix factor(choice, context);
    factor.use_supernodes(baseline_kernels);
    check(factor);
  };
  with_budget(plain.memory(), [&](FactoredMatrix& factor) {
    const auto factored = factor.factor(matrix.rows(), false, assemble);
    REQUIRE_FALSE(factored);
    CHECK(factored.error().code == ErrorCode::OutOfMemory);
  });
  with_budget(plain.memory() + 12 * probe->entries(), [&](FactoredMatrix& factor) {
    REQUIRE(factor.factor(matrix.rows(), false, assemble));
    CHECK(factor.memory() < plain.memory());
    REQUIRE(factor.factor(matrix.rows(), true, assemble));
    CHECK(factor.solve(Field::Random(matrix.rows(), 3)));
  });
}
