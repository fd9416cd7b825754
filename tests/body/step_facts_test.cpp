#include "pliant/body/step_facts.hpp"

#include <algorithm>
#include <random>

#include "body/sheets.hpp"
#include "pliant/body/triangle_body.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

StepFacts facts_on(const Body& body, const BodyInputs& inputs, StepFacts reuse = {}) {
  const StepPlan plan = body.look(inputs).value();
  return facts_of(inputs, plan, body.settings().combine, std::move(reuse));
}

StepFacts facts_on(const Mesh& mesh, std::vector<SampledForce> forces,
                   Border border = Border::Clamped) {
  const TriangleBody body(std::make_shared<TriangleSurface>(make_surface(mesh).value()),
                          {.measure = Measure::Rest, .border = border});
  return facts_on(body, inputs_of(std::move(forces)));
}

SampledForce push_at(const Vector3d& center, double deformation_radius, double force_radius) {
  return {PointForce{center, {0, 1, 0}}, 1, deformation_radius, force_radius, Falloff::Constant};
}

}  // namespace

TEST_CASE("boxes fall apart where they would form several islands", "[body][facts]") {
  std::mt19937 random(4);
  const auto pick = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  int apart = 0;
  constexpr int trials = 400;
  for (int trial = 0; trial < trials; ++trial) {
    const Grid grid{40, 30, 1, 1, trial % 2 == 1};
    std::vector<Box> boxes;
    Selection selection;
    selection.grid = grid;
    for (int k = pick(1, 6); k > 0; --k) {
      const int i = pick(0, 39), j = pick(0, 25);
      const int last = i + pick(1, 8);
      const Box box{i, grid.is_closed_u ? last : std::min(last, 39), j, j + pick(1, 4)};
      selection.forces.emplace_back();  // selects nothing
      selection.forces.emplace_back().deformation = box;
      boxes.push_back(box);
    }
    selection.regions = combine(boxes, Combine::Box, grid);
    std::vector<Box> room = {{1, 2, 3, 4}};
    const bool is_apart = falls_apart(selection, room);
    CHECK(is_apart == (merged(boxes, grid).size() > 1));
    apart += is_apart ? 1 : 0;
  }
  CHECK(apart > trials / 4);
  CHECK(apart < trials - trials / 8);
}

TEST_CASE("facts of each force are its own, in any order and in used memory", "[body][facts]") {
  const NodeSheet s = flat_sheet(41, 21);
  const GridBody body(s.grid, s.rest, {.measure = Measure::Rest});
  SampledForce outside = press(-15, 0, 1e3);
  outside.deformation_radius = 0;
  const std::vector<SampledForce> forces = {press(-3, 0, 1e3), press(3, 0, 0), outside,
                                            press(90, 0, 1e3)};
  const StepFacts facts = facts_on(body, inputs_of(forces));
  StepFacts turned = facts_on(body, inputs_of({forces.rbegin(), forces.rend()}), facts);
  std::reverse(turned.forces.begin(), turned.forces.end());
  CHECK(turned == facts);
  REQUIRE(facts.forces.size() == 4);
  CHECK(facts.is_solved);
  CHECK(facts.forces[0].pushes);
  CHECK(facts.forces[0].is_push_awaited);
  CHECK(facts.forces[1].touches);
  CHECK_FALSE(facts.forces[1].is_push_awaited);  // it has no magnitude
  CHECK(facts.forces[2].is_outside);
  CHECK_FALSE(facts.forces[3].touches);
}

TEST_CASE("facts tell why a force on a surface moves nothing", "[body][facts][surface]") {
  const Mesh mesh = square(8, 1, 0);  // a spacing of 0.125
  const auto first = [](const StepFacts& facts) { return facts.forces.at(0); };

  const StepFacts moving = facts_on(mesh, {push_at({0, 0, 0}, 0.3, 0.2)});
  CHECK(moving.is_solved);
  CHECK(first(moving).pushes);
  CHECK_FALSE(moving.has_loose_patch);

  const StepFacts between = facts_on(mesh, {push_at({0.06, 0, 0.03}, 0.02, 0.02)});
  CHECK(first(between).is_between_nodes);
  CHECK(first(between).touches);
  CHECK_FALSE(first(between).is_too_small);
  CHECK_FALSE(between.is_solved);
  CHECK_FALSE(first(facts_on(mesh, {push_at({0.06, 5, 0.03}, 0.02, 0.02)})).is_between_nodes);

  const StepFacts held = facts_on(mesh, {push_at({0.5, 0, 0.5}, 0.1, 0.1)});  // its only node
  CHECK(first(held).is_too_small);
  CHECK_FALSE(held.is_solved);

  const StepFacts loose = facts_on(mesh, {push_at({0, 0, 0}, 5, 5)}, Border::Free);
  CHECK(loose.has_loose_patch);
  CHECK_FALSE(loose.is_solved);

  const StepFacts aside =
      facts_on(mesh, {push_at({-0.2, 0, 0}, 0.2, 0.2), push_at({0.4, 0, 0}, 0, 0.1)});
  CHECK(aside.is_solved);
  CHECK(aside.forces[1].is_outside);
  CHECK_FALSE(aside.forces[1].pushes);

  // A force that selects nothing, at a node and beside one.
  for (const double x : {0.0, 0.03}) {
    const StepFacts pushing =
        facts_on(mesh, {push_at({0, 0, 0}, 0.3, 0), push_at({x, 0, 0}, 0, 0.1)});
    CHECK_FALSE(pushing.forces[1].is_between_nodes);
    CHECK(pushing.forces[1].touches);
    CHECK(pushing.forces[1].pushes);
  }
}
