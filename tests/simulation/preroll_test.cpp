#include <string>
#include <vector>

#include "pliant/sampling/sampling.hpp"
#include "pliant/simulation/live.hpp"
#include "pliant/states/state_store.hpp"
#include "support/catch.hpp"
#include "support/moving_scene.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

namespace {

constexpr int ahead = 7;

// The scene that starts `ahead` frames earlier, as its frames from the other's start on.
std::vector<std::string> states_from_earlier_start(Scene s) {
  const int start = s.start;
  s.start -= ahead;
  for (Surface& surface : s.surfaces) {
    if (surface.solver.start_frame) *surface.solver.start_frame -= ahead;
  }
  auto simulation = Simulation::make(s).value();
  std::vector<std::string> states;
  for (int frame = start; frame <= s.end; ++frame) states.push_back(state_at(simulation, frame));
  return states;
}

Scene prerolled(Scene s, int frames = ahead) {
  for (Surface& surface : s.surfaces) surface.solver.preroll = frames;
  return s;
}

// Without a keyed rate, whose sum begins at the scene's start.
Scene moving(Integrator integrator) {
  Scene s = moving_scene();
  std::get<NoiseChannels>(s.forces[1].kind).rate = 2;
  for (Surface& surface : s.surfaces) surface.solver.integrator = integrator;
  return s;
}

}  // namespace

TEST_CASE("a preroll has the bits of a scene that starts earlier",
          "[simulation][preroll][threads]") {
  const Scene s = moving(GENERATE(Integrator::BackwardEuler, Integrator::Newmark));
  const auto expected = states_from_earlier_start(s);
  CHECK(all_states(prerolled(s)) == expected);
  CHECK(all_states(s) != expected);
  auto simulation = Simulation::make(prerolled(s), {.threads = 3}).value();
  for (const int frame : {20, 3, 28, 4, 11, 10, 27}) {
    CAPTURE(frame);
    CHECK(state_at(simulation, frame) == expected[static_cast<std::size_t>(frame - s.start)]);
  }
  CHECK(simulation.frames().size() == expected.size());
  CHECK_FALSE(simulation.at(s.start - 1));
  CHECK_FALSE(simulation.at(s.start - 1 - ahead));
}

TEST_CASE("each surface has a preroll of its own, ahead of its own start",
          "[simulation][preroll]") {
  Scene s = scene({sheet("a"), sheet("b")}, {poke("p", {1.5, 0, -2})});
  s.surfaces[1].solver.start_frame = 6;
  const Scene plain = s;
  s.surfaces[0].solver.preroll = 4;
  s.surfaces[1].solver.preroll = 3;
  Scene earlier = plain;
  earlier.start -= 4;
  earlier.surfaces[1].solver.start_frame = 3;
  const auto a = baked(s, "a"), b = baked(s, "b");
  const auto earlier_a = baked(earlier, "a"), earlier_b = baked(earlier, "b");
  for (std::size_t k = 0; k < a.size(); ++k) {
    CAPTURE(k);
    CHECK(a[k] == earlier_a[k + 4]);
    CHECK(b[k] == earlier_b[k + 4]);
  }
  CHECK(b[2] == b[0]);  // at rest up to frame 3
  CHECK(b[3] != b[0]);
}

TEST_CASE("a preroll begins before frame 0, and may be all that is solved",
          "[simulation][preroll]") {
  Scene s = scene({sheet("s")}, {poke("p", {1.5, 0, -2})}, 1);
  s.surfaces[0].solver.preroll = 5;
  Scene earlier = s;
  earlier.start = -4;
  earlier.surfaces[0].solver.preroll = 0;
  CHECK(baked(s, "s").front() == baked(earlier, "s").back());
  CHECK(Simulation::make(s)->warnings().empty());
}

TEST_CASE("channels are checked in the preroll of what uses them", "[simulation][preroll]") {
  Scene s = scene({sheet("s"), sheet("still")}, {poke("p", {1.5, 0, -2})});
  CurveKeys<1> keys;
  keys.keys = {{.frame = 1, .value = {1}}, {.frame = 3, .value = {3}}};
  for (Key<1>& key : keys.keys) key.next.kind = Interpolation::Kind::Linear;
  keys.before = {Extrapolation<1>::Kind::Linear};
  const Curve<1> falling = Curve<1>::make(keys).value();
  s.surfaces[0].solver.preroll = 5;
  Scene other = s;
  other.surfaces[1].material.density = falling;  // the other surface has no preroll
  CHECK(Simulation::make(other));
  s.surfaces[0].material.density = falling;
  const auto refused = Simulation::make(s);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("s.density at frame -4 is -4"));
  s.surfaces[0].material.density = 40;
  s.forces[0].force_radius = falling;
  const auto refused_radius = Simulation::make(s);
  REQUIRE_FALSE(refused_radius);
  CHECK_THAT(refused_radius.error().message, Contains("p.forceRadius at frame -4 is -4"));
}

TEST_CASE("a keyed rate is summed backwards from the scene's first frame",
          "[simulation][preroll]") {
  Scene s = scene({sheet("s")}, {poke("gust", {})});
  s.forces[0].kind = NoiseChannels{.rate = curve({{-3, 1}, {0, 2.5}, {5, 4}})};
  s.surfaces[0].solver.preroll = 4;
  const SceneSampling sampling(s);
  const auto time_at = [&](int frame) {
    const SurfaceInputs inputs = sample_inputs(s, sampling, 0, frame);
    return std::get<NoiseForce>(inputs.body.forces[0].kind).time;
  };
  const Channel<1>& rate = std::get<NoiseChannels>(s.forces[0].kind).rate;
  for (int frame = -3; frame < 8; ++frame) {
    CAPTURE(frame);
    // Each frame adds its rate.
    CHECK_THAT(time_at(frame + 1) - time_at(frame),
               Catch::Matchers::WithinAbs(rate.at(frame)[0] / s.fps, 1e-14));
  }
  CHECK(time_at(1) == rate.at(1)[0] * (1 / s.fps));
  CHECK(time_at(-3) == time_at(-3));
}

TEST_CASE("states of a preroll are stored, and restored", "[simulation][preroll]") {
  const Scene s = prerolled(moving_scene());
  MemoryStateStore store(std::size_t{1} << 28);
  const auto expected = all_states(s);
  auto first = Simulation::make(s, {.store = &store}).value();
  for (const int frame : first.frames()) CHECK(state_at(first, frame) == expected[frame - s.start]);
  CHECK(first.frame_counts().solved == static_cast<int>(expected.size()) - 1 + ahead);
  auto second = Simulation::make(s, {.store = &store}).value();
  for (const int frame : second.frames())
    CHECK(state_at(second, frame) == expected[frame - s.start]);
  CHECK(second.frame_counts().solved == 0);
  // A checkpoint, even of the first frame, needs no preroll.
  auto third = Simulation::make(s).value();
  REQUIRE(third.restore(expected[0]).value() == s.start);
  CHECK(state_at(third, s.start + 1) == expected[1]);
  CHECK(third.frame_counts().solved == 1);
  // One of a scene without the preroll is not its own.
  CHECK_FALSE(Simulation::make(prerolled(moving_scene(), 0))->restore(expected[0]));
}

TEST_CASE("a live run plays the preroll, and its performance has the same bits",
          "[simulation][preroll]") {
  const Scene s = prerolled(moving_scene());
  auto live = LiveSimulation::make(s, {.records = true}).value();
  CHECK(live.frame() == s.start);
  const auto refused = live.set("gust.rate", 3);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("gust.rate") && Contains("preroll"));
  std::vector<Field> played;
  for (int k = 0; k < 8; ++k) {
    if (k == 0) CHECK(live.set("first.damping", 30));
    if (k == 0) CHECK(live.set("second.damping", 35));
    if (k == 0) CHECK(live.set("first.rotate", Value<3>{0, 1, 0}));
    if (k == 2) CHECK(live.set("gust.rate", 3));
    if (k == 3) CHECK(live.set("travelling.magnitude", 5000));
    played.push_back(live.positions()->surface("first").positions());
    CHECK(live.advance());
  }
  const auto baked_again = baked(live.performance().value(), "first");
  for (std::size_t k = 0; k < played.size(); ++k) {
    CAPTURE(k);
    CHECK(played[k] == baked_again[k]);
  }
  // What is set at the first frame has no effect on the preroll.
  CHECK(played[0] == baked(s, "first")[0]);
}

TEST_CASE("a preview tells the peak of the frames that are shown", "[simulation][preroll]") {
  Scene s = scene({sheet("s")}, {poke("p", {1.5, 0, -2})});
  s.forces[0].magnitude = curve({{-12, 0}, {-8, 6000}, {-4, 0}, {1, 10}});
  s.surfaces[0].solver.preroll = 14;
  auto simulation = Simulation::make(s).value();
  const auto previews = preview_forces(s, simulation.rest_shapes()).value();
  const PlayedPeak played = previews.back().played.value();
  double largest = 0;
  for (const int frame : simulation.frames())
    largest = std::max(largest, simulation.at(frame)->surfaces()[0].peak_displacement());
  CHECK(played.frame >= s.start);
  CHECK_THAT(played.peak, Catch::Matchers::WithinRel(largest, 1e-12));
}
