#include "pliant/plate/sparse/sparse_factor.hpp"

#include "support/catch.hpp"
#include "support/plates.hpp"

using namespace pliant;
using pliant::testing::assemble_upper;
using pliant::testing::unit_grid;

TEST_CASE("a factor takes the bytes that its analysis tells", "[plate][factor]") {
  const SparseMatrix matrix = assemble_upper({unit_grid(40, 30), {1, 2, 1}, 0});
  for (const SolverChoice choice : available_solvers()) {
    if (choice == SolverChoice::Spectral) continue;
    CAPTURE(name_of(choice));
    const auto factor = make_sparse_factor(choice);
    REQUIRE(factor->analyze(matrix));
    const std::size_t found = factor->bytes();
    REQUIRE(factor->factorize(matrix, {}));
    CHECK(factor->bytes() == found);
    REQUIRE(factor->factorize(matrix, {}));
    CHECK(factor->bytes() == found);
  }
}
