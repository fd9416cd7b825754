#include <algorithm>

#include "region/select.hpp"
#include "support/catch.hpp"

using namespace pliant;

namespace {

// Node (i,j) is at (i, 0, j).
Field lattice(const Grid& grid) {
  Field nodes(grid.node_count(), 3);
  for (int node = 0; node < grid.node_count(); ++node) {
    nodes.row(node) << node % grid.columns, 0, node / grid.columns;
  }
  return nodes;
}

SampledForce at(double x, double z, double deformation, double force) {
  return {PointForce{{x, 0, z}, {0, 1, 0}}, 3, deformation, force, Falloff::Constant};
}

const Grid grid{30, 20, 1, 1};

}  // namespace

TEST_CASE("a force acts in the island that its deformation box is part of", "[region][islands]") {
  // The force box of the third extends into the first's island; the fourth selects nothing.
  const std::vector<SampledForce> forces{at(5, 5, 3, 2), at(8, 7, 3, 2), at(22, 12, 3, 18),
                                         at(5, 5, 0, 4)};
  const Field nodes = lattice(grid);
  const Selection selection = select_region(grid, nodes, forces, Combine::Islands);
  REQUIRE(selection.regions.size() == 2);
  CHECK(selection.regions[0].box == Box{3, 10, 3, 9});
  CHECK(selection.regions[1].box == Box{20, 24, 10, 14});
  CHECK(selection.box() == Box{3, 24, 3, 14});
  const auto region = [&](int k) { return selection.forces[k].region; };
  CHECK(std::array{region(0), region(1), region(2), region(3)} == std::array{0, 0, 1, -1});
  const Field first = assemble_load(grid, nodes, forces, selection, 0);
  const Field alone = assemble_load(grid, nodes, {forces.data(), 2},
                                    select_region(grid, nodes, {forces.data(), 2}));
  CHECK(first == alone);
  CHECK(assemble_load(grid, nodes, forces, selection, 1).col(1).isConstant(3));
}

TEST_CASE("in a box and a union a force acts wherever its box reaches", "[region][union]") {
  const std::vector<SampledForce> forces{at(5, 5, 3, 0), at(22, 12, 3, 30), at(5, 5, 0, 4)};
  for (const Combine how : {Combine::Box, Combine::Union}) {
    const Field nodes = lattice(grid);
    const Selection selection = select_region(grid, nodes, forces, how);
    REQUIRE(selection.regions.size() == 1);
    for (const ForceSelection& force : selection.forces) CHECK(force.region == 0);
    const Field load = assemble_load(grid, nodes, forces, selection);
    CHECK(load(0, 1) == 6);  // both forces
  }
}

TEST_CASE("a force without a box of its own acts in the island of its selector",
          "[region][islands]") {
  const std::vector<SampledForce> forces{at(5, 5, 3, 0), at(22, 12, 3, 0), at(20, 11, 0, 2)};
  const std::vector<int> selectors{0, 1, 1};
  const Selection selection =
      select_region(grid, lattice(grid), forces, Combine::Islands, selectors);
  CHECK(select_region(grid, lattice(grid), forces, Combine::Islands).forces[2].region == -1);
  CHECK(selection.forces[2].region == selection.forces[1].region);
  CHECK(selection.forces[2].region != selection.forces[0].region);
}

TEST_CASE("other boxes take part in the regions", "[region]") {
  Selection selection;
  selection.forces = {{{2, 4, 2, 4}, {2, 3, 2, 3}, 0}};
  const std::vector<Box> others{{4, 9, 4, 6}, {20, 24, 10, 15}};
  CHECK(recombined(selection, Combine::Box, others).box() == Box{2, 24, 2, 15});
  const Selection islands = recombined(selection, Combine::Islands, others);
  CHECK(islands.others == others);
  REQUIRE(islands.regions.size() == 2);
  CHECK(islands.regions[0].box == Box{2, 9, 2, 6});
  CHECK(islands.forces[0].region == 0);
}

TEST_CASE("a push counts the nodes that move, and only them", "[region]") {
  const Field nodes = lattice(grid);
  const SampledForce force = at(5, 5, 3, 100);
  const std::vector<SampledForce> forces{force, at(8, 8, 3, 1)};
  const Selection selection = select_region(grid, nodes, forces, Combine::Union);
  const std::vector<Patch> patches = selection.regions[0].patches;
  // Two 5 x 5 boxes that overlap in 2 x 2 nodes: 3 x 3 interior nodes each.
  const Push push = push_of(grid, nodes, force, selection.forces[0].force, patches);
  CHECK(push.node_count == 18);
  CHECK(push.sum == Vector3d(0, 54, 0));
  CHECK(pushes(grid, nodes, force, selection.forces[0].force, patches));
  SampledForce idle = force;
  std::get<PointForce>(idle.kind).direction.setZero();
  CHECK_FALSE(pushes(grid, nodes, idle, selection.forces[0].force, patches));
  CHECK_FALSE(pushes(grid, nodes, force, {0, 3, 0, 20}, patches));  // only the rim
}
