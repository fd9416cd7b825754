#include "pliant/plate/rim_load.hpp"

#include "support/catch.hpp"
#include "support/plates.hpp"
#include "support/unions.hpp"

using namespace pliant;
using pliant::testing::apply_stencil;

namespace {

EdgeTangents four_tangents() {
  EdgeTangents tangents;
  tangents.su0 = Vector3d(1, -2, 3);
  tangents.su1 = Vector3d(-4, 5, 0.5);
  tangents.sv0 = Vector3d(0.25, 7, -1);
  tangents.sv1 = Vector3d(2, 0, 11);
  return tangents;
}

}  // namespace

TEST_CASE("the rim's part of a load is that of the stencil", "[plate][spectral]") {
  for (const auto& [columns, rows] : {std::pair{3, 3},
                                      {3, 4},
                                      {4, 3},
                                      {3, 9},
                                      {5, 5},
                                      {6, 7},
                                      {7, 6},
                                      {12, 5},
                                      {5, 12},
                                      {13, 17}}) {
    CAPTURE(columns, rows);
    const Grid grid{columns, rows, 0.25, 0.125};
    const Stiffness stiffness{1.5, 0.75, 3};
    const EdgeTangents tangents = four_tangents();
    const Field w = Field::Random(grid.node_count(), 3);
    const Field load = Field::Random(grid.node_count(), 3);
    Field changed = load;
    subtract_rim(grid, stiffness, tangents, w, changed);

    const Field rim = with_interior(grid, w, Field::Zero(unknown_count(grid), 3));
    const Field expected = interior_of(grid, load) - apply_stencil(grid, stiffness, tangents, rim);
    CHECK(interior_of(grid, changed) == expected);
  }
}

TEST_CASE("the rim's part of a load is that of the stencil on any outline", "[plate][outline]") {
  for (const int side : {10, 13, 34}) {
    for (const auto& [name, grid, interior] : pliant::testing::union_plates(side)) {
      CAPTURE(name, side);
      const Stiffness stiffness{1.5, 0.75, 3};
      const Outline outline(grid, interior);
      const EdgeTangents tangents = four_tangents();
      const Field w = Field::Random(grid.node_count(), 3);
      const Field load = Field::Random(grid.node_count(), 3);
      Field changed = load;
      subtract_rim(outline, stiffness, tangents, w, changed);

      const Field zero = Field::Zero(unknown_count(outline), 3);
      const Field rim = with_interior(outline, w, zero);
      const Field expected =
          interior_of(outline, load) - apply_stencil(outline, stiffness, tangents, rim);
      CHECK(interior_of(outline, changed) == expected);
    }
  }
}
