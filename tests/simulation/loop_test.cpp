#include <atomic>
#include <string>
#include <vector>

#include "pliant/body/body.hpp"
#include "pliant/sampling/sampling.hpp"
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

namespace {

constexpr int cycle = 8;

// A sheet that is pushed to and fro, in a cycle that begins at frame 3.
Scene to_and_fro(Integrator integrator = Integrator::BackwardEuler) {
  Scene s = scene({sheet("s", 11)}, {poke("p", {0.5, 0, -1}, 1)}, 40);
  CurveKeys<1> keys;
  keys.keys = {
      {.frame = 3, .value = {0}}, {.frame = 6, .value = {900}}, {.frame = 11, .value = {0}}};
  keys.after = {Extrapolation<1>::Kind::Repeat};
  s.forces[0].magnitude = Curve<1>::make(keys).value();
  s.surfaces[0].solver.start_frame = 3;
  s.surfaces[0].solver.loop = cycle;
  s.surfaces[0].solver.integrator = integrator;
  s.surfaces[0].material.density = 400;
  s.surfaces[0].material.damping = 700;
  return s;
}

// The rounds in which the cycles of a scene are found.
int rounds_of(const Scene& s, StateStore* store = nullptr) {
  std::atomic<int> rounds = 0;
  SimulationOptions options{.store = store};
  options.round_done = [&](std::string_view, int, double) { ++rounds; };
  CHECK(Simulation::make(s, options)->at(s.end));
  return rounds;
}

// How far one round of solves leads from the state at the beginning, of the largest displacement.
double gap_of(const Scene& s) {
  Simulation simulation = Simulation::make(s).value();
  Scene open = s;
  open.surfaces[0].solver.loop = {};
  const int first = first_solved_frame(s, s.surfaces[0]);
  const SceneSampling sampling(open);
  REQUIRE(simulation.report(first));
  const BodyState begin = simulation.state(0);
  const RestShape& shape = simulation.rest_shapes()[0];
  const auto body = make_body(shape, body_settings(s.surfaces[0], shape.grid.has_value())).value();
  body->restore(begin);
  double peak = 0;
  for (int frame = first; frame < first + *s.surfaces[0].solver.loop; ++frame) {
    peak = std::max(peak, (body->state().positions - body->rest()).rowwise().norm().maxCoeff());
    if (is_solved_at(open, open.surfaces[0], frame))
      REQUIRE(body->step(sample_inputs(open, sampling, 0, frame).body));
  }
  const BodyState& end = body->state();
  return std::max((end.positions - begin.positions).rowwise().norm().maxCoeff(),
                  (end.velocities - begin.velocities).rowwise().norm().maxCoeff() / s.fps) /
         peak;
}

}  // namespace

TEST_CASE("a loop closes, and repeats to the bit", "[simulation][loop]") {
  const Scene s = to_and_fro(GENERATE(Integrator::BackwardEuler, Integrator::Newmark));
  const auto states = all_states(s);
  const auto frames = baked(s, "s");
  CHECK(gap_of(s) <= 1e-6);
  CHECK(frames[0] == frames[1]);               // at rest
  CHECK(peak({frames[0], frames[2]}) > 1e-3);  // at frame 3 it moves already
  for (int frame = 3 + cycle; frame <= s.end; ++frame) {
    CAPTURE(frame);
    CHECK(frames[frame - 1] == frames[frame - 1 - cycle]);
  }
  // The last frame of a cycle leads to its first, in the steps of the others.
  const double step = largest_difference(frames[2], frames[3]);
  CHECK(largest_difference(frames[2 + cycle - 1], frames[2]) < 3 * step);
}

TEST_CASE("a loop is where going round for long ends", "[simulation][loop]") {
  if (is_sanitized) return;
  const Scene s = to_and_fro(GENERATE(Integrator::BackwardEuler, Integrator::Newmark));
  Scene open = s;
  open.surfaces[0].solver.loop = {};
  open.end = 3 + 60 * cycle;
  const auto frames = baked(s, "s"), long_run = baked(open, "s");
  for (int k = 0; k < cycle; ++k) {
    CAPTURE(k);
    CHECK(largest_difference(frames[2 + k], long_run[2 + 59 * cycle + k]) < 2e-6 * peak(frames));
  }
}

TEST_CASE("what is found faster than by going round is the same", "[simulation][loop]") {
  if (is_sanitized) return;
  // It takes some 140 rounds to forget the beginning.
  Scene s = to_and_fro();
  s.surfaces[0].material.damping = 30;
  s.surfaces[0].material.density = 4000;
  s.surfaces[0].solver.measure = Measure::Rest;
  const int rounds = rounds_of(s);
  CAPTURE(rounds);
  CHECK(rounds < 60);
  CHECK(gap_of(s) <= 1e-6);
}

TEST_CASE("frames of loops in any order, and with threads, have the same bits",
          "[simulation][loop][threads]") {
  Scene s = moving_scene();
  s.end = 40;
  s.surfaces[0].solver.loop = 7;
  s.surfaces[1].solver.loop = 5;
  s.surfaces[0].material.damping = 900;
  s.surfaces[1].material.damping = 600;
  const auto expected = all_states(s);
  auto simulation =
      Simulation::make(s, {.checkpoint_bytes = GENERATE(0u, 20'000u, 1u << 28), .threads = 3})
          .value();
  for (const int frame : {40, 3, 21, 10, 9, 12, 11, 40, 5, 6, 7}) {
    CAPTURE(frame);
    CHECK(state_at(simulation, frame) == expected[static_cast<std::size_t>(frame - s.start)]);
  }
  auto second = Simulation::make(s).value();
  for (const int frame : {26, 3, 40}) {
    CAPTURE(frame);
    REQUIRE(second.restore(expected[static_cast<std::size_t>(frame - s.start)]).value() == frame);
    const int next = std::min(frame + 6, s.end);
    CHECK(state_at(second, next) == expected[static_cast<std::size_t>(next - s.start)]);
  }
}

TEST_CASE("a surface beside a loop moves as without it", "[simulation][loop]") {
  Scene s = to_and_fro();
  s.surfaces.push_back(sheet("beside", 11));
  Scene open = s;
  open.surfaces[0].solver.loop = {};
  CHECK(baked(s, "beside") == baked(open, "beside"));
  // From the scene's start on too, where the run begins a frame earlier.
  s.surfaces[0].solver.start_frame = {};
  CHECK(baked(s, "beside") == baked(open, "beside"));
  CHECK(Simulation::make(s)->warnings().empty());
}

TEST_CASE("cycles are stored", "[simulation][loop]") {
  const Scene s = to_and_fro();
  MemoryStateStore store(std::size_t{1} << 28);
  const auto expected = all_states(s);
  CHECK(rounds_of(s, &store) > 0);
  CHECK(rounds_of(s, &store) == 0);
  auto again = Simulation::make(s, {.store = &store}).value();
  for (const int frame : again.frames()) CHECK(state_at(again, frame) == expected[frame - s.start]);
  CHECK(again.frame_counts().solved == 0);
  // What changes the cycle changes its key.
  Scene other = s;
  other.surfaces[0].material.damping = 701;
  CHECK(rounds_of(other, &store) > 0);
  other = s;
  other.surfaces[0].solver.loop = cycle + 1;
  CHECK(rounds_of(other, &store) > 0);
  // A scene that is longer has the same cycle.
  other = s;
  other.end = 60;
  CHECK(rounds_of(other, &store) == 0);
}

TEST_CASE("what is carried away has no cycle, whatever rounding makes of it",
          "[simulation][loop]") {
  Surface free = sheet("s");
  free.tangents = {};
  free.solver.region = SolvedRegion::All;
  free.solver.edges = {Edge::Free, Edge::Free, Edge::Free, Edge::Free};
  if (GENERATE(false, true)) {
    free.reading.uv = UvReading::Surface;
    free.reading.border = Border::Free;
    free.solver.edges = {};
  }
  free.solver.loop = 20;
  free.solver.integrator =
      GENERATE(Integrator::BackwardEuler, Integrator::Newmark, Integrator::Exact);
  free.material.density = is_sanitized ? 3.0 : GENERATE(0.0, 3.0);
  free.material.damping = 1;
  Force wind = poke("wind", {}, 5);
  wind.kind = UniformChannels{};
  wind.force_radius = 99;
  const Scene s = scene({free}, {wind}, 24);
  const auto refused = Simulation::make(s).value().at(2);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::SolverFailed);
  CHECK_THAT(refused.error().message, Contains("cycle of 20 frames") && Contains("carried away"));
}

TEST_CASE("what flies away has no cycle, and the error tells how far", "[simulation][loop]") {
  Surface quad;
  quad.name = "quad";
  quad.shape = mesh_of({{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}}, {{0, 3, 2, 1}});
  quad.reading.uv = UvReading::Surface;
  quad.reading.border = Border::Free;
  quad.solver.region = SolvedRegion::All;
  quad.solver.integrator = GENERATE(Integrator::BackwardEuler, Integrator::Newmark);
  quad.solver.start_frame = 2;
  quad.solver.loop = 4;
  quad.material.damping = is_sanitized ? 0.0 : GENERATE(0.0, 1e-3);
  Force wind = poke("wind", {}, 2);
  wind.kind = UniformChannels{};
  wind.force_radius = 9;
  Scene s = scene({quad}, {wind}, 9);
  auto simulation = Simulation::make(s).value();
  const auto refused = simulation.at(2);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::SolverFailed);
  CHECK_THAT(refused.error().message,
             Contains("surface \"quad\"") && Contains("cycle of 4 frames") &&
                 Contains("rounds it is still carried away, by ") && Contains("damping"));
  CHECK(simulation.at(1));
  CHECK_FALSE(simulation.at(9));
  // Without a load it rests, which is a cycle.
  s.forces[0].magnitude = 0;
  const auto frames = baked(s, "quad");
  CHECK(frames[0] == frames[8]);
}

// Where the acceleration excites stiff vibrations, which only going round damps.
TEST_CASE("what going round finds is found", "[simulation][loop]") {
  const Edge pinned = Edge::Pinned, free_edge = Edge::Free;
  const Edges edges = GENERATE_COPY(Edges{}, Edges{Edge::Clamped, pinned, free_edge, free_edge});
  if (is_sanitized && edges.are_clamped()) return;
  Scene s = scene({sheet("s", 8)}, {poke("p", {0, 0, 0}, 1)}, 14);
  s.surfaces[0].shape = GridSheet{.columns = 8, .rows = 9, .width = 1, .depth = 1};
  s.forces[0].kind = UniformChannels{};
  CurveKeys<1> keys;
  keys.keys = {{.frame = 1, .value = {0}},
               {.frame = 4, .value = {300}},
               {.frame = 8, .value = {-200}},
               {.frame = 11, .value = {0}}};
  for (Key<1>& key : keys.keys) key.next.kind = Interpolation::Kind::Linear;
  keys.after = {Extrapolation<1>::Kind::Repeat};
  s.forces[0].magnitude = Curve<1>::make(keys).value();
  s.surfaces[0].material.density = 0.02;
  s.surfaces[0].material.damping = 0.3;
  s.surfaces[0].solver = {
      .loop = 10, .integrator = Integrator::Newmark, .region = SolvedRegion::All, .edges = edges};
  CHECK(gap_of(s) <= 1e-6);
}

TEST_CASE("a plate whose many vibrations are not damped does not close", "[simulation][loop]") {
  if (is_sanitized) return;  // a thousand rounds
  Scene s = to_and_fro(Integrator::Newmark);
  s.surfaces[0].shape = GridSheet{.columns = 31, .rows = 31, .width = 10, .depth = 10};
  s.surfaces[0].solver.measure = Measure::Rest;
  s.surfaces[0].material.density = 4;
  s.surfaces[0].material.damping = 0;
  const auto refused = Simulation::make(s)->at(3);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("does not close"));
}

TEST_CASE("a search for a cycle can be interrupted", "[simulation][loop]") {
  std::atomic<int> asked = 0;
  SimulationOptions options;
  options.should_stop = [&] { return ++asked > 500; };
  Scene s = to_and_fro(Integrator::Newmark);
  s.surfaces[0].material.damping = 0;
  const auto refused = Simulation::make(s, options)->at(3);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::Interrupted);
  CHECK(asked < 600);
}

TEST_CASE("a loop with halts, and one of a single frame", "[simulation][loop]") {
  Scene s = to_and_fro();
  CurveKeys<1> halted;
  halted.keys = {
      {.frame = 3, .value = {1}}, {.frame = 5, .value = {0}}, {.frame = 8, .value = {2}}};
  for (Key<1>& key : halted.keys) key.next.kind = Interpolation::Kind::Step;
  s.surfaces[0].solver.time_scale = Curve<1>::make(halted).value();
  CHECK(gap_of(s) <= 1e-6);
  const auto frames = baked(s, "s");
  CHECK(frames[4] == frames[5]);
  CHECK(frames[4 + cycle] == frames[5 + cycle]);
  // Of one frame: what it comes to under a load that stays.
  Scene still = to_and_fro();
  still.surfaces[0].solver.loop = 1;
  still.forces[0].magnitude = 700;
  Scene settled = still;
  settled.surfaces[0].solver.loop = {};
  settled.end = 400;
  const auto at_once = baked(still, "s");
  CHECK(at_once[2] == at_once[30]);
  CHECK(largest_difference(at_once[2], baked(settled, "s").back()) < 2e-6 * peak(at_once));
  // Always halted: it stays at rest.
  s.surfaces[0].solver.time_scale = 0;
  CHECK(peak(baked(s, "s")) == 0);
}

TEST_CASE("a cycle's channels are checked beyond the scene's end", "[simulation][loop]") {
  Scene s = to_and_fro();
  s.end = 5;
  s.surfaces[0].material.density = curve({{3, 400}, {9, 400}, {10, -1}});
  const auto refused = Simulation::make(s);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("s.density at frame 10 is -1"));
  s.surfaces[0].solver.start_frame = 6;  // it never starts
  CHECK(Simulation::make(s));
}

TEST_CASE("reports and logs of a loop are those of its first cycle", "[simulation][loop]") {
  const Scene s = to_and_fro();
  auto simulation = Simulation::make(s).value();
  for (const int frame : {3, 7, 10}) {
    const auto report = simulation.report(frame)->surfaces[0];
    const auto later = simulation.report(frame + 2 * cycle)->surfaces[0];
    CHECK(report.frame == frame);
    CHECK(later.frame == frame);
    CHECK(report.regions == later.regions);
    CHECK(report.forces[0].push.sum == later.forces[0].push.sum);
    CHECK(report.forces[0].sampled->magnitude == later.forces[0].sampled->magnitude);
  }
}

TEST_CASE("a live run has no loop", "[simulation][loop]") {
  const auto refused = LiveSimulation::make(to_and_fro());
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("s.loop is 8"));
}

TEST_CASE("a preroll and a loop exclude each other", "[simulation][loop]") {
  Scene s = to_and_fro();
  s.surfaces[0].solver.preroll = 3;
  const auto refused = Simulation::make(s);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("s.preroll is 3 and s.loop is 8"));
  s.surfaces[0].solver.preroll = 0;
  s.surfaces[0].solver.loop = 0;
  CHECK_FALSE(Simulation::make(s));
}
