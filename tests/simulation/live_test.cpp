#include "pliant/simulation/live.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "pliant/scene/channels.hpp"
#include "pliant/scene/read.hpp"
#include "pliant/scene/write.hpp"
#include "support/catch.hpp"
#include "support/everything.hpp"
#include "support/sanitized.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

namespace {

constexpr int frame_count = 9;

LiveOptions recording(int threads = 1) {
  LiveOptions options;
  options.simulation.threads = threads;
  options.records = true;
  return options;
}

/// Plays a live run, which sets the channels for which `is_set(channel, frame)` is true before each
/// step, and requires that all its frames have the bits of its performance.
template <class IsSet>
void check_against_performance(Result<LiveSimulation> live, int frames, const IsSet& is_set) {
  REQUIRE(live);
  const int first = live->frame();
  std::vector<Frame> played;
  for (int k = 0; k < frames; ++k) {
    auto frame = live->positions();
    REQUIRE(frame);
    played.push_back(*std::move(frame));
    const std::vector<NamedChannel> channels = channels_of(live->scene());
    std::vector<std::pair<std::string, std::vector<double>>> values;
    for (const NamedChannel& named : channels) {
      if (is_set(named.path, live->frame())) {
        values.emplace_back(named.path, other_value(named, live->frame()));
      }
    }
    for (const auto& [path, value] : values) {
      CAPTURE(path, live->frame());
      REQUIRE(live->set(path, value));
    }
    REQUIRE(live->advance());
  }
  played.push_back(live->positions().value());
  const auto performance = live->performance();
  REQUIRE(performance);
  CHECK(performance->end == first + frames);
  auto simulation = Simulation::make(*performance);
  REQUIRE(simulation);
  for (const Frame& frame : played) {
    const auto again = simulation->at(frame.number());
    REQUIRE(again);
    for (std::size_t k = 0; k < frame.surfaces().size(); ++k) {
      CAPTURE(frame.number(), frame.surfaces()[k].name());
      CHECK(frame.surfaces()[k].positions() == again->surfaces()[k].positions());
    }
  }
}

}  // namespace

TEST_CASE("a live run has the bits of the scene that has its values as keys, for each channel",
          "[simulation][live]") {
  const Scene scene = of_everything();
  for (const std::string& path : paths_of(scene)) {
    CAPTURE(path);
    if (is_sanitized && path.size() % 4 != 0) continue;
    check_against_performance(LiveSimulation::make(scene, recording()), frame_count,
                              [&](const std::string& channel, int frame) {
                                return channel == path && (frame == 3 || frame == 4 || frame == 7);
                              });
  }
}

TEST_CASE("a live run that sets all channels has the bits of its performance",
          "[simulation][live][threads]") {
  const int every = GENERATE(1, 2, 5);
  const int threads = GENERATE(1, 2);
  check_against_performance(LiveSimulation::make(of_everything(), recording(threads)), frame_count,
                            [&](const std::string& channel, int frame) {
                              return (static_cast<int>(channel.size()) + frame) % every == 0;
                            });
}

namespace {

/// As `of_everything`, with noises whose rates have keys, so that a run from a state may set them.
Scene with_keyed_rates(int preroll) {
  Scene scene = of_everything();
  for (Surface& surface : scene.surfaces) surface.solver.preroll = preroll;
  for (Force& force : scene.forces) {
    if (auto* const noise = std::get_if<NoiseChannels>(&force.kind))
      noise->rate = curve({{-4, 1}, {6, 3}});
  }
  return scene;
}

}  // namespace

TEST_CASE("a run from a state has the bits of its performance, from the scene's start on",
          "[simulation][live][threads]") {
  const Scene scene = with_keyed_rates(GENERATE(0, 2));
  const int from = GENERATE(-2, 0, 3, 9);
  const std::string state = Simulation::make(scene)->state_bytes(from).value();
  for (const int every : {1, 3, 1000}) {
    for (const int threads : {1, 2}) {
      CAPTURE(from, every, threads);
      check_against_performance(
          LiveSimulation::from_state(scene, state, recording(threads)), 4,
          [&](const std::string& channel, int frame) {
            // Ahead of the start the noise was summed from the rate there.
            const bool can_be_set = frame > scene.start || !channel.ends_with(".rate");
            return can_be_set && (static_cast<int>(channel.size()) + frame) % every == 0;
          });
    }
  }
}

TEST_CASE("a run from a state goes on as the simulation, if nothing is set", "[simulation][live]") {
  const Scene scene = of_everything();  // with constant rates
  auto whole = Simulation::make(scene).value();
  const int from = GENERATE(-2, 1, 5);
  auto live =
      LiveSimulation::from_state(scene, whole.state_bytes(from).value(), recording()).value();
  CHECK(live.frame() == from);
  for (int frame = from; frame <= scene.end; ++frame) {
    CAPTURE(frame);
    const Frame shown = live.positions().value(), expected = whole.at(frame).value();
    for (const char* surface : {"sheet", "other"})
      CHECK(shown.surface(surface).positions() == expected.surface(surface).positions());
    REQUIRE(live.advance());
  }
  Scene longer = scene;
  longer.end = live.frame();
  CHECK(live.performance().value() == longer);
}

TEST_CASE("a run begins only with a state of its scene", "[simulation][live]") {
  const Scene scene = of_everything();
  const std::string state = Simulation::make(scene)->state_bytes(4).value();
  const auto refusal = [](const Result<LiveSimulation>& live) {
    REQUIRE_FALSE(live);
    CHECK(live.error().code == ErrorCode::InvalidInput);
    return live.error().message;
  };
  Scene other = scene;
  other.forces[0].magnitude = 401;
  CHECK_THAT(refusal(LiveSimulation::from_state(other, state)), Contains("is not the same"));
  for (const std::string& damaged : {std::string(), state.substr(0, state.size() / 2), state + "x"})
    CHECK_THAT(refusal(LiveSimulation::from_state(scene, damaged)), Contains("damaged"));
  other = scene;
  other.surfaces[0].solver.loop = 5;
  CHECK_THAT(refusal(LiveSimulation::from_state(other, state)), Contains("has no cycle"));
  auto live = LiveSimulation::from_state(scene, state).value();
  const auto refused = live.set("wind.rate", 3);
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message,
             Contains("wind.rate is 3, but a rate without keys cannot be set in a run from a "
                      "state: give it a key"));
}

TEST_CASE("a channel has the value that was set, a pose one frame later", "[simulation][live]") {
  auto live = LiveSimulation::make(of_everything()).value();
  REQUIRE(live.advance());
  const auto value_of = [&](const std::string& path, int frame) {
    std::vector<double> value;
    for (const NamedChannel& named : channels_of(live.scene())) {
      if (named.path == path) value = value_at(named, frame);
    }
    return value;
  };
  for (const std::string& path : paths_of(live.scene())) {
    CAPTURE(path);
    // Colliders go on from where they are as much as surfaces.
    const bool is_pose =
        std::ranges::any_of(std::array{".translate", ".rotate", ".scale", ".radius", ".length",
                                       ".size", ".round", ".offset"},
                            [&](const char* attribute) { return path.ends_with(attribute); });
    const std::vector<double> before = value_of(path, live.frame());
    std::vector<double> value = before;
    for (double& number : value) number = number == 0 ? 1 : number / 2;
    if (path.ends_with("enabled") || path.ends_with("stick")) value = {0};
    REQUIRE(live.set(path, value));
    CHECK(value_of(path, live.frame()) == (is_pose ? before : value));
    CHECK(value_of(path, live.frame() + 1) == value);
    CHECK(value_of(path, 1'000'000) == value);
  }
}

TEST_CASE("a performance that is written and read again has the same bits", "[simulation][live]") {
  LiveOptions options;
  options.records = true;
  auto live = LiveSimulation::make(of_everything(), options).value();
  std::vector<Frame> played;
  for (int k = 0; k < frame_count; ++k) {
    REQUIRE(live.set("poke.center", Value<3>{0.1 * k, 0.5, 0.2 * k}));
    REQUIRE(live.set("wind.rate", 0.3 * k));
    REQUIRE(live.set("sheet.rotate", Value<3>{0, 3.0 * k, 0}));
    REQUIRE(live.set("pair.enabled", k % 2));
    REQUIRE(live.advance());
    played.push_back(live.positions().value());
  }
  const auto text = to_xml(live.performance().value());
  REQUIRE(text);
  auto again = Simulation::make(parse_scene(*text, "scene.xml", "").value()).value();
  for (const Frame& frame : played) {
    CAPTURE(frame.number());
    CHECK(frame.surface("sheet").positions() ==
          again.at(frame.number()).value().surface("sheet").positions());
  }
}

TEST_CASE("a live run has no last frame", "[simulation][live]") {
  Scene s = scene({sheet("sheet")}, {poke("poke", {0, 0, 0})}, 3);
  s.forces[0].magnitude = curve({{1, 100}, {3, 900}});
  Scene longer = s;
  longer.end = 30;
  auto live = LiveSimulation::make(s).value();
  auto whole = Simulation::make(longer).value();
  for (int frame = 1; frame < 30; ++frame) REQUIRE(live.advance());
  CHECK(live.frame() == 30);
  CHECK(live.positions().value().surface("sheet").positions() ==
        whole.at(30).value().surface("sheet").positions());
  CHECK(live.report().value().frame == 30);
}

TEST_CASE("a value that breaks a rule is refused, and changes nothing", "[simulation][live]") {
  const Scene s = scene({sheet("sheet")}, {poke("poke", {0, 0, 0})});
  auto live = LiveSimulation::make(s).value();
  const auto refused = [&](const Result<void>& result) {
    REQUIRE_FALSE(result);
    CHECK(result.error().code == ErrorCode::InvalidInput);
    return result.error().message;
  };
  CHECK_THAT(refused(live.set("poke.magnitud", 1)), Contains("did you mean \"magnitude\"?"));
  CHECK_THAT(refused(live.set("poke.center", 1)), Contains("poke.center is 1, but must be 3 numb"));
  CHECK_THAT(refused(live.set("poke.magnitude", Value<3>{})), Contains("must be 1 number"));
  CHECK_THAT(refused(live.set("poke.magnitude", std::nan(""))), Contains("must be finite"));
  CHECK_THAT(refused(live.set("poke.magnitude", std::numeric_limits<double>::infinity())),
             Contains("must be finite"));
  CHECK_THAT(refused(live.set("poke.forceRadius", -1)), Contains("poke.forceRadius is -1, but"));
  CHECK_THAT(refused(live.set("poke.enabled", 0.5)), Contains("must be 0 or 1"));
  CHECK_THAT(refused(live.set("sheet.scale", Value<3>{1, 0, 1})), Contains("sheet.scale is 1 0 1"));
  REQUIRE(live.advance());
  CHECK(live.positions().value().surface("sheet").positions() == baked(s, "sheet")[1]);

  // Rules between channels are checked once all are set.
  REQUIRE(live.set("sheet.c", -3));
  CHECK_THAT(refused(live.advance()), Contains("sheet.c is -3, but must be greater than"));
  CHECK(live.frame() == 2);
  REQUIRE(live.set("sheet.b", 4));
  REQUIRE(live.advance());
  CHECK(live.frame() == 3);
}

TEST_CASE("a live frame that fails changes nothing, on any surface", "[simulation][live]") {
  bool is_faulty = false;
  Scene s = scene({sheet("a"), sheet("b")}, {poke("poke", {0, 0, 0})});
  Force own{.name = "own", .targets = {"b"}, .magnitude = 1};
  own.kind = CustomForce{.unit_force = [&is_faulty](const Vector3d&, const ForceTime&) {
    if (is_faulty) throw std::runtime_error("broken");
    return Vector3d(0, 1, 0);
  }};
  s.forces.push_back(own);
  auto live = LiveSimulation::make(s).value();
  auto whole = Simulation::make(s).value();
  for (int frame = 1; frame < 5; ++frame) REQUIRE(live.advance());
  is_faulty = true;
  CHECK_THROWS(live.advance());
  is_faulty = false;
  CHECK(live.frame() == 5);
  REQUIRE(live.set("a.dt", 1e-30));
  CHECK_FALSE(live.advance());
  REQUIRE(live.set("a.dt", 0.01));
  for (int frame = 5; frame < 8; ++frame) REQUIRE(live.advance());
  for (const std::string name : {"a", "b"}) {
    CHECK(live.positions().value().surface(name).positions() ==
          whole.at(8).value().surface(name).positions());
  }
}

TEST_CASE("a live frame with an invalid custom force changes nothing", "[simulation][live]") {
  const int surfaces = GENERATE(1, 2);
  bool is_faulty = false;
  Scene s = scene({sheet("a")}, {poke("poke", {0, 0, 0})});
  if (surfaces == 2) s.surfaces.push_back(sheet("b"));
  Force own{.name = "own", .targets = {}, .magnitude = 1};
  own.kind = CustomForce{.unit_force = [&is_faulty](const Vector3d&, const ForceTime&) {
    return Vector3d(0, is_faulty ? std::nan("") : 1, 0);
  }};
  s.forces.push_back(own);
  auto live = LiveSimulation::make(s).value();
  auto whole = Simulation::make(s).value();
  for (int frame = 1; frame < 4; ++frame) REQUIRE(live.advance());
  is_faulty = true;
  const auto failed = live.advance();
  REQUIRE_FALSE(failed);
  CHECK(failed.error().code == ErrorCode::NotFinite);
  is_faulty = false;
  CHECK(live.frame() == 4);
  for (const int frame : {4, 5, 6}) {
    CHECK(live.positions().value().surface("a").positions() ==
          whole.at(frame).value().surface("a").positions());
    REQUIRE(live.advance());
  }
}

TEST_CASE("a live run that is interrupted goes on", "[simulation][live]") {
  bool stops = false;
  const Scene s = scene({sheet("a"), sheet("b")}, {poke("poke", {0, 0, 0})});
  LiveOptions options;
  options.simulation.should_stop = [&stops] { return stops; };
  auto live = LiveSimulation::make(s, options).value();
  REQUIRE(live.advance());
  stops = true;
  const auto stopped = live.advance();
  REQUIRE_FALSE(stopped);
  CHECK(stopped.error().code == ErrorCode::Interrupted);
  stops = false;
  CHECK(live.frame() == 2);
  REQUIRE(live.advance());
  CHECK(live.positions().value().surface("b").positions() == baked(s, "b")[2]);
}

TEST_CASE("a transform that cannot be used is refused while it can still be set",
          "[simulation][live]") {
  Scene s = scene({sheet("sheet")}, {poke("poke", {0, 0, 0})});
  s.surfaces[0].transform.translate = Value<3>{1e200, 0, 0};
  auto far = LiveSimulation::make(s).value();
  const auto refused = far.set("sheet.translate", Value<3>{0, 0, 0});
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("no key can have"));

  s.surfaces[0].transform.translate = Value<3>{0, 0, 0};
  auto live = LiveSimulation::make(s, {.records = true}).value();
  REQUIRE(live.set("sheet.scale", Value<3>{1e-310, 1, 1}));
  const auto told = live.advance();
  REQUIRE_FALSE(told);
  CHECK_THAT(told.error().message, Contains("sheet.scale"));
  CHECK(live.frame() == 1);
  REQUIRE(live.set("sheet.scale", Value<3>{1, 2, 1}));
  REQUIRE(live.advance());
  REQUIRE(live.advance());

  // A scene that its rules forbid is no performance.
  REQUIRE(live.set("sheet.c", -3));
  CHECK_FALSE(live.performance());
  REQUIRE(live.set("sheet.c", 2));
  CHECK(Simulation::make(live.performance().value()));
}
