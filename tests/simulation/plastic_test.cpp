#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "pliant/scene/read.hpp"
#include "pliant/scene/write.hpp"
#include "pliant/simulation/live.hpp"
#include "pliant/states/state_store.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/moving_scene.hpp"
#include "support/sanitized.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

// `yield` and `hardening`: what is bent far stays bent. docs/model.md, "Plasticity".

namespace {

// A panel that a hammer strikes until frame 6; it rings out until frame 24.
Surface panel(double density = 0.02) {
  Surface surface = sheet("s", 15);
  surface.material.density = density;
  surface.material.damping = 0.4;
  surface.solver.measure = Measure::Rest;
  return surface;
}

Surface shell() {
  Surface surface = panel();
  surface.shape = square(10, 5, 0.3);
  surface.solver.measure = {};
  return surface;
}

// Each is bent by about as much.
Scene struck(Surface surface) {
  const double magnitude = std::holds_alternative<Mesh>(surface.shape) ? 500 : 3000;
  Force hammer = poke("hammer", {0.4, 0, -0.3}, magnitude);
  hammer.magnitude = curve({{1, 0}, {4, magnitude}, {7, 0}});
  hammer.deformation_radius = 5.5;
  return scene({std::move(surface)}, {hammer}, 24);
}

Scene yielding(Scene s, double yield, double hardening = 0.1) {
  for (Surface& surface : s.surfaces) {
    surface.material.yield = yield;
    surface.material.hardening = hardening;
  }
  return s;
}

// A yield that most of the panel, or of the shell, passes.
constexpr double soft = 15;

double height(const Field& nodes) { return nodes.col(1).cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("a body that yields nowhere has the elastic bits", "[simulation][plastic]") {
  Surface surface = GENERATE(panel(), shell());
  surface.solver.integrator = GENERATE(Integrator::BackwardEuler, Integrator::Newmark);
  surface.solver.region = GENERATE(SolvedRegion::Forces, SolvedRegion::All);
  const Scene elastic = struck(surface);
  const auto expected = baked(elastic, "s");
  CHECK(peak(expected) > 0.05);
  CHECK((baked(yielding(elastic, 1e9), "s") == expected));
  Scene mapped = yielding(elastic, 1e9);
  const bool is_sheet = std::holds_alternative<GridSheet>(surface.shape);
  const std::size_t count =
      is_sheet ? 15 * 15 : static_cast<std::size_t>(std::get<Mesh>(surface.shape).vertex_count());
  mapped.surfaces[0].maps = {
      {.channel = MapChannel::Yield, .low = 1, .high = 2, .values = std::vector(count, 0.5)}};
  CHECK((baked(mapped, "s") == expected));
}

TEST_CASE("a dent stays, and less of it the higher the yield", "[simulation][plastic]") {
  const Surface surface = GENERATE(panel(), shell());
  const Scene elastic = struck(surface);
  const auto ringing = baked(elastic, "s");
  const double peak_height = peak(ringing);
  CHECK(height(ringing.back()) < 1e-4 * peak_height);
  double last = std::numeric_limits<double>::infinity();
  for (const double yield : {1.0, 1.3, 1.6}) {
    CAPTURE(yield);
    const auto dented = baked(yielding(elastic, yield * soft), "s");
    CHECK(height(dented.back()) > 2e-3 * peak_height);
    CHECK(height(dented.back()) < last);
    last = height(dented.back());
    // It has come to rest in its new shape.
    CHECK(largest_difference(dented.back(), dented[dented.size() - 2]) < 1e-2 * last);
  }
}

TEST_CASE("no frame of a yielding body depends on the way to it",
          "[simulation][plastic][threads]") {
  Scene s = moving_scene();
  s.surfaces[1].solver.release = Release::Freeze;
  s.surfaces[1].solver.combine = Combine::Islands;
  s.surfaces[1].solver.integrator = Integrator::Newmark;
  s.surfaces[1].solver.preroll = 3;
  Surface third = shell();
  third.name = "third";
  s.surfaces.push_back(third);
  s = yielding(std::move(s), 2);
  s.surfaces[0].material.yield = curve({{3, 2}, {20, 1}});
  s.surfaces[0].material.hardening = curve({{3, 0.1}, {20, 0.4}});
  const auto expected = all_states(s);
  Scene elastic = s;
  for (Surface& surface : elastic.surfaces) surface.material.yield = {};
  if (!is_sanitized) CHECK(baked(s, "first").back() != baked(elastic, "first").back());
  auto simulation = Simulation::make(s, {.threads = 3}).value();
  for (const int frame : {20, 3, 28, 4, 11, 10, 27}) {
    if (is_sanitized && frame > 20) break;  // there and back once
    CAPTURE(frame);
    CHECK(state_at(simulation, frame) == expected[static_cast<std::size_t>(frame - s.start)]);
  }
}

TEST_CASE("what has yielded is kept in a state", "[simulation][plastic]") {
  const Scene s = yielding(struck(GENERATE(panel(), shell())), soft);
  auto straight = Simulation::make(s).value();
  const auto state = straight.state_bytes(10).value();
  auto restored = Simulation::make(s).value();
  REQUIRE(restored.restore(state).value() == 10);
  CHECK(state_at(restored, 20) == state_at(straight, 20));
  CHECK(height(restored.at(24)->surface("s").positions()) > 0.02);
}

TEST_CASE("a yield that is keyed holds from its frame on", "[simulation][plastic]") {
  const Surface surface = GENERATE(panel(), shell());
  const Scene elastic = struck(surface);
  Scene keyed = elastic;
  CurveKeys<1> keys;
  keys.keys = {{.frame = 1, .value = {1e9}}, {.frame = 4, .value = {soft}}};
  for (Key<1>& key : keys.keys) key.next.kind = Interpolation::Kind::Step;
  keyed.surfaces[0].material.yield = Curve<1>::make(keys).value();
  const auto of_elastic = baked(elastic, "s"), of_keyed = baked(keyed, "s");
  // The solve of frame 4 leads to frame 5.
  CHECK(of_keyed[3] == of_elastic[3]);
  CHECK(of_keyed[4] != of_elastic[4]);
}

TEST_CASE("a map of yield says where a body bends for good", "[simulation][plastic]") {
  // The left half is elastic.
  Scene s = yielding(struck(panel()), 1);
  MaterialMap map{.channel = MapChannel::Yield, .low = soft, .high = 1e9};
  for (int node = 0; node < 15 * 15; ++node) map.values.push_back(node % 15 < 7 ? 1 : 0);
  s.surfaces[0].maps = {map};
  auto simulation = Simulation::make(s).value();
  REQUIRE(simulation.report(24));
  const PlasticField& plastic = simulation.state(0).plastic;
  double left = 0, right = 0;
  for (int node = 0; node < 15 * 15; ++node) {
    double& side = node % 15 < 7 ? left : right;
    side = std::max(side, plastic.row(node).cwiseAbs().maxCoeff());
  }
  CHECK(left == 0);
  CHECK(right > 0.1);
}

TEST_CASE("a yielding body is played live with the same bits", "[simulation][plastic][live]") {
  const Scene s = yielding(struck(panel()), soft);
  auto live = LiveSimulation::make(s, {.records = true}).value();
  std::vector<Field> played = {live.positions()->surface("s").positions()};
  for (int frame = 2; frame <= 12; ++frame) {
    if (frame == 4) REQUIRE(live.set("s.yield", 2 * soft));
    if (frame == 6) REQUIRE(live.set("s.hardening", 0.3));
    REQUIRE(live.advance());
    played.push_back(live.positions()->surface("s").positions());
  }
  CHECK_FALSE(live.set("s.yield", 0));
  const Scene performance = live.performance().value();
  const auto expected = baked(performance, "s");
  for (std::size_t k = 0; k < played.size(); ++k) CHECK(played[k] == expected[k]);
  CHECK(played.back() != baked(s, "s")[played.size() - 1]);
}

TEST_CASE("a yield is written and read", "[simulation][plastic]") {
  Scene s = yielding(struck(panel()), soft);
  s.surfaces[0].material.hardening = curve({{1, 0.1}, {9, 0.2}});
  const std::string text = to_xml(s).value();
  CHECK_THAT(text, Contains("yield=\"15\""));
  CHECK(all_states(parse_scene(text, "a.xml", "").value()) == all_states(s));
}

TEST_CASE("what yields needs a sound law", "[simulation][plastic]") {
  const Scene sound = yielding(struck(panel()), soft);
  CHECK(Simulation::make(sound));
  const auto refused = [&](const auto& change, const std::string& message) {
    Scene s = sound;
    change(s.surfaces[0]);
    const auto made = Simulation::make(s);
    CAPTURE(message);
    REQUIRE_FALSE(made);
    CHECK_THAT(made.error().message, Contains(message));
  };
  refused([](Surface& s) { s.material.yield = 0; }, "s.yield is 0, but must be greater than 0");
  refused([](Surface& s) { s.material.hardening = -1; }, "s.hardening is -1");
  refused([](Surface& s) { s.material.poisson = 1; },
          "s.poisson is 1, but with yield it must be between -1 and 1");
  refused([](Surface& s) { s.material.c = 0.1; },
          "c = 0.1 must be greater than 2 poisson sqrt(b d) = 0.6");
  refused([](Surface& s) { s.material.density = s.material.damping = s.material.hardening = 0; },
          "s.hardening is 0, but must be greater than 0 where density and damping are 0");
  refused([](Surface& s) { s.solver.integrator = Integrator::Exact; },
          "s.yield: s.integrator is \"exact\"");
  refused([](Surface& s) { s.solver.reference = Reference::None; },
          "s.yield: s.reference is \"none\"");
  refused([](Surface& s) { s.solver.combine = Combine::Union; }, "s.yield: s.combine is \"union\"");
  refused([](Surface& s) { s.solver.release = Release::Recover; },
          "s.yield: s.release is \"recover\"");
  refused([](Surface& s) { s.solver.loop = 5; }, "s.yield: s.loop is \"5\"");
}
