#include "pliant/feedback/frame_report.hpp"

#include <cmath>

#include "pliant/forces/force.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

// Two forces that move towards each other and are disabled at the end, on a surface that recovers.
Scene meeting(Combine how) {
  Scene s = scene({sheet("s", 31), sheet("off"), sheet("late", 9)}, {}, 16);
  s.surfaces[0].solver.combine = how;
  s.surfaces[0].solver.release = Release::Recover;
  s.surfaces[0].material.density = 400;
  s.surfaces[0].material.damping = 900;
  s.surfaces[1].enabled = false;
  s.surfaces[2].solver.start_frame = 9;
  for (const double side : {-1.0, 1.0}) {
    Force force = poke(side < 0 ? "left" : "right", {}, 60000 * side);
    force.kind =
        PointChannels{.center = vector_curve({{1, {9 * side, 0, side}}, {8, {2 * side, 0, side}}})};
    force.enabled = switch_at({{1, true}, {10, false}});
    s.forces.push_back(force);
  }
  return s;
}

bool same(const FrameReport& a, const FrameReport& b) {
  for (std::size_t k = 0; k < a.surfaces.size(); ++k) {
    const SurfaceReport &p = a.surfaces[k], &q = b.surfaces[k];
    if (p.regions != q.regions || p.unknown_count != q.unknown_count ||
        p.recovering != q.recovering || p.settled != q.settled ||
        p.forces.size() != q.forces.size())
      return false;
    for (std::size_t n = 0; n < p.forces.size(); ++n) {
      if (p.forces[n].selection != q.forces[n].selection ||
          p.forces[n].push.sum != q.forces[n].push.sum)
        return false;
    }
  }
  return a.frame == b.frame;
}

}  // namespace

TEST_CASE("a report tells what the solve at its frame moves", "[feedback][report]") {
  const Combine how = GENERATE(Combine::Box, Combine::Islands, Combine::Union);
  auto simulation = Simulation::make(meeting(how)).value();
  std::size_t most_regions = 0;
  int recovering = 0, shapes = 0;
  for (int frame = 1; frame < 16; ++frame) {
    const FrameReport report = simulation.report(frame).value();
    const SurfaceReport& s = report.surfaces[0];
    const Field before = simulation.at(frame)->surface("s").positions();
    const Field after = simulation.at(frame + 1)->surface("s").positions();
    int moved = 0;
    for (int node = 0; node < 31 * 31; ++node) {
      bool is_held = false;
      for (const Region& region : s.regions) {
        for (const Patch& patch : region.patches) is_held |= patch.holds(node % 31, node / 31);
        shapes += region.parts.size() > 1;
      }
      const bool has_moved = before.row(node) != after.row(node);
      moved += is_held;
      // Nodes that move are solved; the others may only settle.
      if (has_moved && !is_held)
        CHECK((after.row(node) == simulation.rest_shapes()[0].rest.row(node)));
    }
    CHECK(s.unknown_count == moved);
    CHECK(s.is_solved == (moved > 0));
    CHECK(s.steps.count == 5);
    CHECK(s.forces.size() == (frame < 10 ? 2 : 0));
    CHECK(report.surfaces[1].forces.empty());
    CHECK(report.surfaces[2].forces.size() == (frame == 9 ? 2 : 0));
    most_regions = std::max(most_regions, s.regions.size());
    recovering += s.recovering;
  }
  CHECK(recovering > 0);
  CHECK((most_regions > 1) == (how == Combine::Islands));
  CHECK((shapes > 0) == (how == Combine::Union));
}

TEST_CASE("a report is the same in any order and whatever is kept", "[feedback][report][threads]") {
  const Scene s = meeting(GENERATE(Combine::Islands, Combine::Union));
  std::vector<FrameReport> expected;
  auto in_order = Simulation::make(s).value();
  for (int frame = 1; frame <= 16; ++frame) expected.push_back(in_order.report(frame).value());
  const std::size_t kept = GENERATE(std::size_t{0}, std::size_t{300'000}, std::size_t{1} << 28);
  auto simulation = Simulation::make(s, {.checkpoint_bytes = kept, .threads = 2}).value();
  for (const int frame : {16, 3, 12, 11, 1, 16, 9}) {
    CHECK(same(simulation.report(frame).value(), expected[frame - 1]));
  }
  CHECK_FALSE(simulation.report(17));
}

TEST_CASE("recovering frames have the same bits in any order", "[feedback][recover][threads]") {
  const Scene s = meeting(GENERATE(Combine::Box, Combine::Islands, Combine::Union));
  const auto expected = baked(s, "s");
  const std::size_t kept = GENERATE(std::size_t{0}, std::size_t{300'000}, std::size_t{1} << 28);
  for (const int threads : {1, 3}) {
    auto simulation = Simulation::make(s, {.checkpoint_bytes = kept, .threads = threads}).value();
    for (const int frame : {16, 2, 13, 12, 16, 5, 11, 1}) {
      CHECK(simulation.at(frame)->surface("s").positions() == expected[frame - 1]);
    }
  }
}

TEST_CASE("the load told of is the load in world space", "[feedback][report]") {
  Scene s = scene({sheet("s")}, {poke("f", {0, 0, 0}, 700)}, 3);
  s.surfaces[0].transform.scale = Value<3>{1, 2, 0.5};
  s.forces[0].kind = PointChannels{.center = Value<3>{0, 0, 0}, .direction = Value<3>{0, 3, 4}};
  auto simulation = Simulation::make(s).value();
  const ForceReport force = simulation.report(1)->surfaces[0].forces.at(0);
  REQUIRE(force.push.node_count > 0);
  CHECK((force.push.sum - force.push.node_count * 700 * Vector3d(0, 0.6, 0.8)).norm() < 1e-9);
}

TEST_CASE("a report may outlive the simulation, custom forces included", "[feedback][report]") {
  Scene s = scene({sheet("s")}, {poke("f", {0, 0, 0})}, 3);
  s.forces[0].kind = CustomForce{
      .distance = {}, .unit_force = [](const Vector3d& p, const ForceTime&) -> Vector3d {
        return p.x() > 100 ? Vector3d::Constant(std::nan("")) : Vector3d(0, 1, 0);
      }};
  const FrameReport report = [&] {
    auto simulation = Simulation::make(s).value();
    s = {};
    return simulation.report(2).value();
  }();
  const ForceKind& shape = report.surfaces[0].forces.at(0).sampled->kind;
  CHECK(unit_force(shape, {1, 2, 3}) == Vector3d(0, 1, 0));
  CHECK(unit_force(shape, {101, 0, 0}) == Vector3d::Zero());
}
