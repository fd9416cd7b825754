#include "pliant/simulation/state_file.hpp"

#include "pliant/files/read_file.hpp"
#include "support/catch.hpp"
#include "support/moving_scene.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;

TEST_CASE("a run goes on from its state in a file, bit for bit", "[simulation][state_file]") {
  const ScratchFolder folder;
  const Scene s = moving_scene();
  const auto expected = all_states(s);
  const int frame = GENERATE(3, 4, 11, 28);
  auto first = Simulation::make(s).value();
  REQUIRE(write_state(folder.file("at"), first, frame));
  auto second = Simulation::make(s, {.checkpoint_bytes = GENERATE(0u, 1u << 28)}).value();
  CHECK(read_state(folder.file("at"), second).value() == frame);
  for (int at = frame; at <= s.end; ++at) {
    CHECK(state_at(second, at) == expected[static_cast<std::size_t>(at - s.start)]);
  }
  CHECK(second.frame_counts().solved == s.end - frame);
  CHECK(state_at(second, s.start) == expected.front());  // and back
  CHECK(state_at(second, 9) == expected[6]);
}

TEST_CASE("a state outlives an edit of what comes later", "[simulation][state_file]") {
  Scene s = moving_scene();
  auto first = Simulation::make(s).value();
  const std::string state = first.state_bytes(10).value();
  s.forces[0].magnitude = sampled_until(s.forces[0].magnitude, 10, 500);
  auto second = Simulation::make(s).value();
  CHECK(second.restore(state).value() == 10);
  CHECK(state_at(second, s.end) == all_states(s).back());

  s.forces[0].magnitude = sampled_until(s.forces[0].magnitude, 8, 400);
  auto third = Simulation::make(s).value();
  const auto refused = third.restore(state);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::InvalidInput);
  CHECK_THAT(refused.error().message,
             contains_text("surface \"first\", its channels or forces before frame 10, or the "
                           "engine is not the same"));
  CHECK(state_at(third, s.end) == all_states(s).back());
}

TEST_CASE("a state of something else is refused", "[simulation][state_file]") {
  const Scene s = scene({sheet("s")}, {poke("f", {0, 0, 0})});
  auto simulation = Simulation::make(s).value();
  const auto refusal = [&](const std::string& bytes) {
    const auto refused = simulation.restore(bytes);
    return refused ? std::string() : refused.error().message;
  };
  const std::string good = simulation.state_bytes(8).value();
  CHECK(refusal(good).empty());
  CHECK_THAT(refusal("anything"), contains_text("not a saved state, or it is damaged"));
  auto longer = Simulation::make(scene({sheet("s")}, {poke("f", {0, 0, 0})}, 20)).value();
  CHECK_THAT(refusal(longer.state_bytes(15).value()),
             contains_text("frame 15 is outside the scene's frames 1 to 12"));
  CHECK(refusal(longer.state_bytes(12).value()).empty());
  auto two = Simulation::make(scene({sheet("s"), sheet("t")}, {})).value();
  CHECK_THAT(refusal(two.state_bytes(8).value()), contains_text("2 surfaces, but the scene has 1"));
  auto other = Simulation::make(scene({sheet("s", 11)}, {poke("f", {0, 0, 0})})).value();
  CHECK_THAT(refusal(other.state_bytes(8).value()), contains_text("is not the same"));
  const Field expected = Simulation::make(s)->at(12)->surface("s").positions();
  CHECK(simulation.at(12)->surface("s").positions() == expected);

  // A force of the program: pliant cannot compare its function; the program must keep it the same.
  Scene own = s;
  own.forces[0].kind = CustomForce{.unit_force = [](const Vector3d&, const ForceTime&) -> Vector3d {
    return {0, 1, 0};
  }};
  auto unknown = Simulation::make(own).value();
  CHECK_FALSE(refusal(unknown.state_bytes(8).value()).empty());
  auto again = Simulation::make(own).value();
  CHECK(again.restore(unknown.state_bytes(8).value()).value() == 8);
  CHECK(state_at(again, 12) == state_at(unknown, 12));
}

TEST_CASE("a state that was cut or changed is refused", "[simulation][state_file]") {
  const Scene s = scene({sheet("s", 5)}, {poke("f", {0, 0, 0})});
  auto simulation = Simulation::make(s).value();
  const std::string bytes = simulation.state_bytes(8).value();
  const std::string at_end = simulation.state_bytes(12).value();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    REQUIRE_FALSE(simulation.restore(std::string_view(bytes).substr(0, size)));
    std::string changed = bytes;
    changed[size] = static_cast<char>(changed[size] ^ (1 << size % 8));
    REQUIRE_FALSE(simulation.restore(changed));
  }
  CHECK(state_at(simulation, 12) == at_end);
}

TEST_CASE("a state file that cannot be read or written is told by name",
          "[simulation][state_file]") {
  const ScratchFolder folder;
  auto simulation = Simulation::make(scene({sheet("s")}, {})).value();
  const auto unwritten = write_state(folder.file("none/at"), simulation, 3);
  REQUIRE_FALSE(unwritten);
  CHECK(unwritten.error().file == folder.file("none/at").string());
  CHECK(read_state(folder.file("none"), simulation).error().code == ErrorCode::Unreadable);
  const auto bad = read_state(folder.write("bad", "text"), simulation);
  REQUIRE_FALSE(bad);
  CHECK(bad.error().file == folder.file("bad").string());
}
