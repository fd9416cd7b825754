#include <algorithm>
#include <atomic>
#include <numeric>
#include <random>
#include <thread>

#include "pliant/simulation/simulation.hpp"
#include "support/catch.hpp"
#include "support/moving_scene.hpp"
#include "support/sanitized.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

// Bytes of one frame's states of `moving_scene`.
std::size_t bytes_of_state() {
  auto simulation = Simulation::make(moving_scene()).value();
  std::size_t bytes = 0;
  for (const RestShape& shape : simulation.rest_shapes()) {
    const auto nodes = static_cast<std::size_t>(shape.grid->node_count());
    bytes += nodes * 6 * sizeof(double);
  }
  return bytes +
         static_cast<std::size_t>(simulation.rest_shapes()[1].grid->node_count());  // it recovers
}

}  // namespace

TEST_CASE("frames in any order are those of playing through, whatever is kept",
          "[simulation][random-access]") {
  const Scene s = moving_scene();
  const auto expected = all_states(s);
  std::mt19937 random(GENERATE(1, 2, 3, 4, 5, 6));
  const std::size_t kept = std::uniform_int_distribution<std::size_t>(0, 30)(random);
  auto simulation = Simulation::make(s, {.checkpoint_bytes = kept * bytes_of_state()}).value();
  std::vector<int> order(expected.size());
  std::iota(order.begin(), order.end(), s.start);
  for (int round = 0; round < 2; ++round) {
    std::shuffle(order.begin(), order.end(), random);
    for (const int frame : order) {
      CAPTURE(kept, frame);
      REQUIRE(state_at(simulation, frame) == expected[static_cast<std::size_t>(frame - s.start)]);
    }
  }
}

TEST_CASE("once a run has been played, a frame costs less than an interval",
          "[simulation][random-access]") {
  const Scene s = moving_scene();
  const int frames = s.end - s.start;
  const std::size_t kept = GENERATE(0u, 1u, 2u, 3u, 5u, 8u, 12u, 40u);
  auto simulation = Simulation::make(s, {.checkpoint_bytes = kept * bytes_of_state()}).value();
  REQUIRE(simulation.at(s.end));
  CHECK(simulation.frame_counts().solved == frames);
  // The interval that FrameCache documents.
  const auto room = static_cast<int>(kept);
  const int interval = room == 0        ? frames
                       : frames <= room ? 1
                                        : 2 * frames / (std::max(1, room / 2) + 1);
  std::mt19937 random(7);
  for (int n = 0; n < rounds(100); ++n) {
    const int before = simulation.frame_counts().solved;
    REQUIRE(simulation.at(std::uniform_int_distribution(s.start, s.end)(random)));
    CAPTURE(kept, interval);
    CHECK(simulation.frame_counts().solved - before <= interval);
    if (frames <= room) CHECK(simulation.frame_counts().solved == frames);
  }
}

TEST_CASE("playing backwards solves each frame about once more", "[simulation][random-access]") {
  const Scene s = moving_scene();
  const int frames = s.end - s.start;
  // 5 checkpoints and as many other frames: room for an interval.
  auto simulation = Simulation::make(s, {.checkpoint_bytes = 10 * bytes_of_state()}).value();
  REQUIRE(simulation.at(s.end));
  for (int frame = s.end; frame >= s.start; --frame) REQUIRE(simulation.at(frame));
  CHECK(simulation.frame_counts().solved <= 2 * frames);
}

TEST_CASE("kept frames never take memory that a solver needs", "[simulation][random-access]") {
  // The region grows in the middle of the run.
  Scene s = scene({sheet("s", 41)}, {poke("f", {0, 0, 0})}, 24);
  s.forces[0].deformation_radius = curve({{1, 4}, {12, 4}, {13, 40}});
  const SolverChoice solver = SolverChoice::Eigen;
  const auto expected = Simulation::make(s, {.solver = solver})->at(24)->surface("s").positions();
  // The memory needed without keeping any state.
  std::size_t enough = 0;
  for (std::size_t most = 1'000'000; enough == 0; most += most / 16) {
    auto simulation =
        Simulation::make(s, {.checkpoint_bytes = 0, .max_memory = most, .solver = solver});
    if (simulation && simulation->at(24)) enough = most;
  }
  auto simulation = Simulation::make(s, {.max_memory = enough, .solver = solver}).value();
  CHECK(simulation.at(24)->surface("s").positions() == expected);
  CHECK(simulation.at(13));
  CHECK(simulation.at(24)->surface("s").positions() == expected);
}

TEST_CASE("simulations in several threads do not disturb each other",
          "[simulation][random-access][threads]") {
  const Scene s = moving_scene();
  const auto expected = all_states(s);
  MemoryStateStore store(bytes_of_state() * 8);
  std::vector<std::jthread> threads;
  std::atomic<int> wrong = 0;
  for (unsigned seed = 0; seed < 4; ++seed) {
    threads.emplace_back([&, seed] {
      auto simulation = Simulation::make(s, {.checkpoint_bytes = 4 * bytes_of_state(),
                                             .threads = 1 + static_cast<int>(seed % 2),
                                             .store = seed < 2 ? nullptr : &store})
                            .value();
      std::mt19937 random(seed);
      for (int n = 0; n < 25; ++n) {
        const int frame = std::uniform_int_distribution(s.start, s.end)(random);
        if (state_at(simulation, frame) != expected[static_cast<std::size_t>(frame - s.start)]) {
          ++wrong;
        }
      }
    });
  }
  threads.clear();
  CHECK(wrong == 0);
}
