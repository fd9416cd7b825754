#include "pliant/states/state_store.hpp"

#include <algorithm>
#include <atomic>
#include <functional>
#include <numeric>
#include <random>
#include <thread>

#include "support/catch.hpp"
#include "support/moving_scene.hpp"
#include "support/sanitized.hpp"
#include "support/scenes.hpp"
#include "support/shared_store.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

constexpr std::size_t plenty = std::size_t{1} << 30;

// A step curve with the channel's samples at the frames around a scene; those from frame k on are
// passed through `change`.
template <int D, class AnyChannel>
Curve<D> sampled(const AnyChannel& channel, int k,
                 const std::function<Value<D>(Value<D>)>& change) {
  CurveKeys<D> keys;
  for (int frame = -2; frame <= 40; ++frame) {
    const Value<D> value = channel.at(frame);
    Key<D> key{.frame = static_cast<double>(frame), .value = frame >= k ? change(value) : value};
    key.next.kind = Interpolation::Kind::Step;
    keys.keys.push_back(key);
  }
  return Curve<D>::make(std::move(keys)).value();
}

void scale_from(Channel<1>& channel, int k) {
  channel = sampled<1>(channel, k, [](Value<1> value) { return Value<1>{value[0] * 1.125}; });
}

template <class AnyChannel>
void shift_from(AnyChannel& channel, int k) {
  channel = sampled<3>(channel, k, [](Value<3> value) {
    return Value<3>{value[0] + 0.125, value[1] + 0.125, value[2] + 0.125};
  });
}

// Changes one channel from frame k on.
struct Edit {
  const char* channel;
  void (*apply)(Scene& scene, int k);
  int delay = 0;     // frames until the sampled value changes
  int surface = -1;  // the surface concerned; -1: any
};

const std::vector<Edit> edits = {
    {"density", [](Scene& s, int k) { scale_from(s.surfaces[0].material.density, k); }, 0, 0},
    {"damping", [](Scene& s, int k) { scale_from(s.surfaces[1].material.damping, k); }, 0, 1},
    {"b", [](Scene& s, int k) { scale_from(s.surfaces[0].material.b, k); }, 0, 0},
    {"c", [](Scene& s, int k) { scale_from(s.surfaces[0].material.c, k); }, 0, 0},
    {"d", [](Scene& s, int k) { scale_from(s.surfaces[1].material.d, k); }, 0, 1},
    {"dt", [](Scene& s, int k) { scale_from(s.surfaces[0].solver.dt, k); }, 0, 0},
    {"translate", [](Scene& s, int k) { shift_from(s.surfaces[0].transform.translate, k); }, 0, 0},
    {"rotate", [](Scene& s, int k) { shift_from(s.surfaces[1].transform.rotate, k); }, 0, 1},
    {"scale", [](Scene& s, int k) { shift_from(s.surfaces[0].transform.scale, k); }, 0, 0},
    {"su1",
     [](Scene& s, int k) {
       auto& tangent = std::get<Channel<1>>(s.surfaces[0].tangents.su1);
       tangent = sampled<1>(tangent, k, [](Value<1>) { return Value<1>{0.5}; });
     },
     0, 0},
    {"magnitude", [](Scene& s, int k) { scale_from(s.forces[1].magnitude, k); }, 0, 0},
    {"forceRadius", [](Scene& s, int k) { scale_from(s.forces[1].force_radius, k); }, 0, 0},
    {"frequency",
     [](Scene& s, int k) { scale_from(std::get<NoiseChannels>(s.forces[1].kind).frequency, k); }, 0,
     0},
    // The noise's time at a frame is a sum over the frames before it.
    {"rate", [](Scene& s, int k) { scale_from(std::get<NoiseChannels>(s.forces[1].kind).rate, k); },
     1, 0},
    {"group radius", [](Scene& s, int k) { scale_from(s.groups[0].deformation_radius, k); }},
    {"group center", [](Scene& s, int k) { shift_from(s.groups[0].center, k); }},
};

std::vector<std::string> states_of(const Scene& scene, StateStore& store, FrameCounts& counts,
                                   std::vector<std::string>* warnings = nullptr) {
  auto simulation = Simulation::make(scene, {.checkpoint_bytes = 0, .store = &store}).value();
  std::vector<std::string> states;
  for (const int frame : simulation.frames()) states.push_back(state_at(simulation, frame));
  counts = simulation.frame_counts();
  if (warnings) {
    for (const Warning& warning : simulation.warnings()) warnings->push_back(warning.message());
  }
  return states;
}

// Returns damaged bytes now and then.
class BadStore final : public StateStore {
 public:
  explicit BadStore(unsigned seed) : random_(seed) {}
  bool holds(const Hash& key) override { return good_.holds(key); }
  std::optional<std::string> read(const Hash& key, std::size_t most) override {
    auto bytes = good_.read(key, most);
    if (!bytes || random_() % 3 == 0) return bytes;
    if (random_() % 2 == 0) {
      bytes->resize(random_() % bytes->size());
    } else {
      (*bytes)[random_() % bytes->size()] ^= static_cast<char>(1 << random_() % 8);
    }
    return bytes;
  }
  void write(const Hash& key, std::string_view bytes) override { good_.write(key, bytes); }
  void discard(const Hash& key) override {
    good_.discard(key);
    ++discarded;
  }
  int discarded = 0;

 private:
  MemoryStateStore good_{plenty};
  std::mt19937 random_;
};

}  // namespace

TEST_CASE("an edit costs the frames from where it takes effect", "[states][store]") {
  const Edit edit = GENERATE(from_range(edits));
  std::mt19937 random(static_cast<unsigned>(std::hash<std::string_view>()(edit.channel)));
  Scene scene = moving_scene();
  MemoryStateStore store(plenty);
  FrameCounts counts;
  // The same samples, expressed differently.
  edit.apply(scene, 1000);
  CHECK(states_of(scene, store, counts) == all_states(moving_scene()));
  CHECK(counts.solved == scene.end - scene.start);
  CHECK(counts.read == 0);
  CHECK(states_of(moving_scene(), store, counts) == all_states(moving_scene()));
  CHECK(counts.solved == 0);
  CHECK(counts.read == scene.end - scene.start);

  std::vector<int> frames(static_cast<std::size_t>(scene.end - scene.start + 4));
  std::iota(frames.begin(), frames.end(), scene.start);
  std::shuffle(frames.begin(), frames.end(), random);
  frames.resize(
      is_sanitized ? 1 : 4);  // each once, since the store already has the states of earlier edits
  for (const int k : frames) {
    Scene edited = scene;
    edit.apply(edited, k);
    CAPTURE(edit.channel, k);
    CHECK(states_of(edited, store, counts) == all_states(edited));
    // Inputs before the second surface starts, or at the last frame, do not affect any state.
    const int sampled_at = k > scene.start ? k + edit.delay : k;
    const int effect = std::max(sampled_at, edit.surface == 1 ? 6 : scene.start);
    CHECK(counts.solved == std::max(0, scene.end - effect));
    CHECK(counts.read == scene.end - scene.start - counts.solved);
  }
}

TEST_CASE("what changes no bit of a state need not be solved again", "[states][store]") {
  MemoryStateStore store(plenty);
  FrameCounts counts;
  Scene s = moving_scene();
  const auto expected = states_of(s, store, counts);
  s.surfaces[0].name = "renamed";
  s.forces[0].name = "too";
  s.forces[1].targets = {"renamed"};
  std::swap(s.surfaces[0], s.surfaces[1]);
  s.end = 20;
  states_of(s, store, counts);
  CHECK(counts.solved == 0);
  s.end = 40;  // a longer run continues where the other one ended
  states_of(s, store, counts);
  CHECK(counts.solved == 12);
  CHECK(counts.read == 25);
}

TEST_CASE("whatever decides a state is in its key", "[states][store]") {
  MemoryStateStore store(plenty);
  FrameCounts counts;
  Scene s = scene({sheet("s")}, {poke("f", {0, 0, 0})});
  s.surfaces[0].tangents.sv0 = Channel<1>(0.0);
  states_of(s, store, counts);
  const auto solves_all = [&](const std::function<void(Scene&)>& change) {
    Scene changed = s;
    change(changed);
    const auto states = states_of(changed, store, counts);
    return counts.solved == 11 && states == all_states(changed);
  };
  const auto settings = [](Scene& scene) -> SolverSettings& { return scene.surfaces[0].solver; };
  CHECK(solves_all([&](Scene& t) { settings(t).stepping = Stepping::Overshoot; }));
  CHECK(solves_all([&](Scene& t) { settings(t).reference = Reference::None; }));
  CHECK(solves_all([&](Scene& t) { settings(t).measure = Measure::Rest; }));
  CHECK(solves_all([&](Scene& t) { settings(t).combine = Combine::Islands; }));
  CHECK(solves_all([&](Scene& t) { settings(t).release = Release::Recover; }));
  CHECK(solves_all([](Scene& t) { t.fps = 25; }));
  CHECK(solves_all([](Scene& t) {
    t.surfaces[0].shape = GridSheet{.columns = 13, .rows = 13, .width = 12.5, .depth = 12};
  }));
  CHECK(solves_all([](Scene& t) { t.forces[0].falloff = Falloff::Linear; }));
  CHECK(solves_all([](Scene& t) { t.forces[0].falloff_curve = curve({{0, 1}, {1, 0.5}}); }));
  CHECK(solves_all([](Scene& t) { t.forces[0].falloff_curve = curve({{0, 1}, {1, 0.25}}); }));
  CHECK(solves_all([](Scene& t) { t.forces.push_back(t.forces[0]), t.forces[1].name = "g"; }));
  CHECK(solves_all([](Scene& t) {
    t.forces.push_back(poke("h", {0, 0, 0}, 0));
    t.forces[1].group = "g";
    t.groups.push_back({.name = "g"});
  }));
  // Only one of these values is random; the others give the same bits.
  Scene same = s;
  same.seed = 5;
  same.surfaces[0].tangents.sv0 = Channel<3>(Value<3>{0, 0, 0});
  states_of(same, store, counts);
  CHECK(counts.solved == 0);
}

TEST_CASE("solvers of other bits do not share states", "[states][store]") {
  const Scene s = scene({sheet("s")}, {poke("f", {0, 0, 0})});
  MemoryStateStore store(plenty);
  for (const SolverChoice choice : {SolverChoice::Spectral, SolverChoice::Eigen}) {
    auto simulation = Simulation::make(s, {.solver = choice, .store = &store}).value();
    REQUIRE(simulation.at(12));
    CHECK(simulation.frame_counts().solved == 11);
  }
}

TEST_CASE("warnings are those of a full run, though nothing is solved", "[states][store]") {
  Scene s = moving_scene();
  s.forces.push_back(poke("nowhere", {100, 0, 0}));
  s.forces.push_back(poke("tiny", {0, 0, 0}));
  s.forces.back().deformation_radius = 0.5;
  s.forces.back().enabled = switch_at({{3, false}, {25, true}});
  s.surfaces.push_back(sheet("still"));
  s.surfaces.back().tangents.su0 = Channel<1>(0.5);
  for (Force& force : s.forces) {
    if (force.targets.empty()) force.targets = {"first", "second"};
  }
  MemoryStateStore store(plenty);
  FrameCounts counts;
  std::vector<std::string> solved, read;
  states_of(s, store, counts, &solved);
  REQUIRE(solved.size() >= 4);
  states_of(s, store, counts, &read);
  CHECK(counts.solved == 0);
  CHECK(read == solved);
  auto simulation = Simulation::make(s, {.store = &store}).value();
  REQUIRE(simulation.at(s.end));  // without the frames in between
  CHECK(simulation.warnings().size() == solved.size());
}

TEST_CASE("a store that damages what it keeps changes no result", "[states][store]") {
  const Scene s = moving_scene();
  const auto expected = all_states(s);
  BadStore store(GENERATE(1, 2, 3));
  for (int n = 0; n < 3; ++n) {
    FrameCounts counts;
    CHECK(states_of(s, store, counts) == expected);
    CHECK(counts.solved + counts.read == s.end - s.start);
  }
  CHECK(store.discarded > 0);
  auto simulation = Simulation::make(s, {.checkpoint_bytes = 0, .store = &store}).value();
  std::mt19937 random(3);
  for (int n = 0; n < 60; ++n) {
    const int frame = std::uniform_int_distribution(s.start, s.end)(random);
    CHECK(state_at(simulation, frame) == expected[static_cast<std::size_t>(frame - s.start)]);
  }
}

TEST_CASE("threads share a store in memory", "[states][store][threads]") {
  MemoryStateStore large(plenty);
  CHECK(share(large) == shared_states);
  MemoryStateStore small(200'000);
  CHECK(share(small) > 0);
  CHECK(small.bytes() <= small.byte_budget());
}

TEST_CASE("a store that is too small is of less use", "[states][store]") {
  const Scene s = moving_scene();
  const auto expected = all_states(s);
  const std::size_t budget = GENERATE(0u, 1000u, 30'000u, 100'000u);
  MemoryStateStore store(budget);
  for (int n = 0; n < 2; ++n) {
    FrameCounts counts;
    CHECK(states_of(s, store, counts) == expected);
    CHECK(counts.solved > 0);
    CHECK(store.bytes() <= budget);
  }
}

TEST_CASE("with a store no frame that was passed is solved again", "[states][store]") {
  const Scene s = moving_scene();
  const auto expected = all_states(s);
  MemoryStateStore store(plenty);
  auto simulation = Simulation::make(s, {.checkpoint_bytes = 0, .store = &store}).value();
  REQUIRE(simulation.at(s.end));
  std::mt19937 random(3);
  for (int n = 0; n < 60; ++n) {
    const int frame = std::uniform_int_distribution(s.start, s.end)(random);
    CHECK(state_at(simulation, frame) == expected[static_cast<std::size_t>(frame - s.start)]);
  }
  CHECK(simulation.frame_counts().solved == s.end - s.start);
}

TEST_CASE("a program's own force is known by the key that it is given", "[states][store]") {
  MemoryStateStore store(plenty);
  const auto run = [&](double strength, const std::string& key) {
    Scene s = scene({sheet("s"), sheet("t", 9)}, {poke("f", {0, 0, 0})});
    s.forces[0].targets = {"t"};
    Force own = poke("own", {});
    own.targets = {"s"};
    own.enabled = switch_at({{1, false}, {5, true}});
    own.kind = CustomForce{.unit_force = [=](const Vector3d&, const ForceTime& time) -> Vector3d {
                             return {0, strength * time.seconds, 0};
                           },
                           .key = key};
    s.forces.push_back(own);
    FrameCounts counts;
    CHECK((states_of(s, store, counts) == all_states(s)));
    return counts.solved;
  };
  CHECK(run(1, "") == 11);
  CHECK(run(1, "") == 7);  // unknown from frame 5 on
  CHECK(run(2, "") == 7);
  CHECK(run(1, "one") == 7);
  CHECK(run(1, "one") == 0);
  CHECK(run(2, "two") == 7);
}

TEST_CASE("frames that failed are not kept", "[states][store]") {
  Scene s = scene({sheet("s")}, {poke("f", {0, 0, 0})});
  std::get<PointChannels>(s.forces[0].kind).direction = Value<3>{0, 1, 0};
  bool is_sound = false;
  s.forces[0].kind = CustomForce{
      .unit_force = [&](const Vector3d&, const ForceTime& time) -> Vector3d {
        return {0, time.frame < 6 || is_sound ? 1.0 : std::numeric_limits<double>::infinity(), 0};
      },
      .key = "sound"};
  MemoryStateStore store(plenty);
  auto simulation = Simulation::make(s, {.store = &store}).value();
  CHECK_FALSE(simulation.at(12));
  CHECK_FALSE(simulation.at(7));
  CHECK(simulation.at(6));
  is_sound = true;
  FrameCounts counts;
  CHECK((states_of(s, store, counts) == all_states(s)));
  CHECK(counts.solved == 6);
}
