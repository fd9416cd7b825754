#include <cstddef>
#include <string>
#include <thread>
#include <vector>

#include "pliant/core/shelf.hpp"
#include "pliant/plate/exact/sparse_motion.hpp"
#include "pliant/plate/sparse/factored_matrix.hpp"
#include "support/catch.hpp"
#include "support/plates.hpp"
#include "support/sanitized.hpp"

using namespace pliant;
using pliant::testing::assemble_upper;
using pliant::testing::is_sanitized;
using pliant::testing::unit_grid;

namespace {

SparseMatrix plate_matrix(double shift) {
  return assemble_upper({is_sanitized ? unit_grid(13, 11) : unit_grid(25, 20), {1, 2, 1}, shift});
}

std::vector<SolverChoice> factors() {
  std::vector<SolverChoice> choices;
  for (const SolverChoice choice : available_solvers())
    if (choice != SolverChoice::Spectral) choices.push_back(choice);
  return choices;
}

}  // namespace

TEST_CASE("a factor from the shelf has the bits and the memory of one that is made",
          "[plate][factor][shelf]") {
  const SparseMatrix one = plate_matrix(0), other = plate_matrix(3);
  const Field forces = Field::Random(one.rows(), 3);
  for (const SolverChoice choice : factors()) {
    CAPTURE(name_of(choice));
    Shelf shelf(std::size_t{1} << 30U);
    const RunContext shared{.shelf = &shelf};
    FactoredMatrix first(choice, shared);
    REQUIRE(first.factor(one, false));
    FactoredMatrix alone(choice, {});
    FactoredMatrix second(choice, shared);
    bool has_same_pattern = false;
    // Found, made after a factor that was found, found again, and made in a pattern that is known.
    for (const SparseMatrix& matrix : {one, other, one, plate_matrix(7)}) {
      REQUIRE(alone.factor(matrix, has_same_pattern));
      REQUIRE(second.factor(matrix, has_same_pattern));
      has_same_pattern = true;
      CHECK(second.solve(forces).value() == alone.solve(forces).value());
      CHECK(second.memory() == alone.memory());
    }
    CHECK(alone.counts().factorizations == 4);
    CHECK(second.counts().factorizations == (choice == SolverChoice::Eigen ? 4 : 2));
    // The first one is as it was.
    REQUIRE(alone.factor(one, true));
    CHECK(first.solve(forces).value() == alone.solve(forces).value());
  }
}

TEST_CASE("a factor from the shelf fits where one that is made fits", "[plate][factor][shelf]") {
  constexpr int parts = is_sanitized ? 10 : 50;
  const SparseMatrix matrix = plate_matrix(0);
  for (const SolverChoice choice : factors()) {
    Shelf shelf(std::size_t{1} << 30U);
    FactoredMatrix first(choice, {.shelf = &shelf});
    REQUIRE(first.factor(matrix, false));
    int count = 0;
    for (std::size_t bytes = 0; bytes < 3 * first.memory(); bytes += first.memory() / parts) {
      const auto outcome = [&](Shelf* from) {
        MemoryBudget budget(bytes);
        FactoredMatrix own(choice, {.memory = &budget, .shelf = from});
        const auto made = own.factor(matrix, false);
        return made ? std::string() : made.error().message;
      };
      CHECK(outcome(&shelf) == outcome(nullptr));
      count += outcome(&shelf).empty() ? 1 : 0;
    }
    CHECK(count > parts / 5);
    CHECK(count < 3 * parts - parts / 5);
  }
}

TEST_CASE("complex factors from the shelf have the bits and the memory of those that are made",
          "[plate][exact][shelf]") {
  const SparseMatrix stiffness = plate_matrix(0);
  const auto size = static_cast<std::size_t>(stiffness.rows());
  const auto moving = [&](double density) {
    // Some unknowns have no mass.
    return MovingMatrix{stiffness, std::vector<double>(size - 20, density),
                        std::vector<double>(size - 20, 0.5)};
  };
  const TimeSteps steps{1, 0.1, Integrator::Exact};
  const ForceChange forces{Field::Random(stiffness.rows(), 3), Field::Random(stiffness.rows(), 3)};
  struct Outcome {
    Field w, v;
    std::size_t memory;
    SolverCounts counts;
  };
  const auto move = [&](double density, Shelf* shelf, MemoryBudget* memory) -> Result<Outcome> {
    SparseMotion motion({.memory = memory, .shelf = shelf});
    if (auto ready = motion.prepare(moving(density)); !ready) return fail(ready.error());
    Field w = Field::Zero(stiffness.rows() - 20, 3), v = w;
    if (auto moved = motion.advance(steps, forces, w, v); !moved) return fail(moved.error());
    return Outcome{w, v, motion.memory(), motion.counts()};
  };
  Shelf shelf(std::size_t{1} << 30U);
  REQUIRE(move(1, &shelf, nullptr));
  const Outcome alone = move(1, nullptr, nullptr).value(), found = move(1, &shelf, nullptr).value();
  CHECK(found.w == alone.w);
  CHECK(found.v == alone.v);
  CHECK(found.memory == alone.memory);
  CHECK(alone.counts.factorizations > 0);
  CHECK(found.counts.factorizations == 0);
  CHECK(found.counts.analyses == 0);
  // Of another density only the order is found.
  const Outcome other = move(2, &shelf, nullptr).value();
  CHECK(other.w == move(2, nullptr, nullptr).value().w);
  CHECK(other.counts.factorizations == alone.counts.factorizations);
  CHECK(other.counts.analyses == 0);
  for (std::size_t bytes = 0; bytes < 2 * alone.memory;
       bytes += alone.memory / (is_sanitized ? 5 : 30)) {
    const auto outcome = [&](Shelf* from) {
      MemoryBudget budget(bytes);
      const auto moved = move(1, from, &budget);
      return moved ? std::string() : moved.error().message;
    };
    CHECK(outcome(&shelf) == outcome(nullptr));
  }
}

TEST_CASE("several threads solve with one factor", "[plate][factor][shelf][threads]") {
  const SparseMatrix matrix = plate_matrix(1);
  const Field forces = Field::Random(matrix.rows(), 3);
  const SolverChoice choice = GENERATE(from_range(factors()));
  FactoredMatrix alone(choice, {});
  REQUIRE(alone.factor(matrix, false));
  const Field wanted = alone.solve(forces).value();
  Shelf shelf(std::size_t{1} << 30U);
  std::vector<int> wrong(4);
  {
    std::vector<std::jthread> threads;
    for (int thread = 0; thread < 4; ++thread) {
      threads.emplace_back([&, thread] {
        for (int k = 0; k < 5; ++k) {
          FactoredMatrix own(choice, {.shelf = &shelf});
          if (!own.factor(matrix, false)) ++wrong[thread];
          for (int n = 0; n < 5; ++n) wrong[thread] += own.solve(forces).value() == wanted ? 0 : 1;
        }
      });
    }
  }
  CHECK(wrong == std::vector<int>(4));
}
