#include "pliant/sweep/sweep.hpp"

#include <atomic>
#include <map>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "pliant/core/shelf.hpp"
#include "pliant/sampling/shape_shelf.hpp"
#include "pliant/scene/changes/change_texts.hpp"
#include "support/caches.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

Scene poked(int end = 8) {
  return scene({sheet("sheet", 11)}, {poke("poke", {0, 0, 0}, 900)}, end);
}

Sweep sweep_of(const std::vector<std::string>& vary, Scene base = poked()) {
  return Sweep::make({std::move(base)}, Takes::make({.vary = vary}).value()).value();
}

std::vector<std::size_t> all_takes(const Sweep& sweep) {
  std::vector<std::size_t> takes(sweep.takes().count());
  std::iota(takes.begin(), takes.end(), std::size_t{0});
  return takes;
}

using Outcomes = std::map<std::size_t, TakeOutcome>;

Outcomes run_all(const Sweep& sweep, SweepRun run = {}) {
  Outcomes outcomes;
  run.take_done = [&](const TakeOutcome& outcome) {
    CHECK(outcomes.emplace(outcome.take, outcome).second);
    return Result<void>();
  };
  REQUIRE(sweep.run(all_takes(sweep), run));
  CHECK(outcomes.size() == sweep.takes().count());
  return outcomes;
}

Measures measures_of(const Scene& scene) {
  auto simulation = Simulation::make(scene).value();
  Measurer measurer(simulation);
  for (const int frame : simulation.frames()) measurer.add(simulation.at(frame).value());
  return measurer.measures().value();
}

std::string sweep_complaint(const std::vector<std::string>& vary,
                            const std::vector<std::string>& set = {}) {
  const auto sweep = Sweep::make({poked()}, Takes::make({.set = set, .vary = vary}).value());
  REQUIRE_FALSE(sweep);
  CHECK(sweep.error().code == ErrorCode::InvalidInput);
  return sweep.error().message;
}

}  // namespace

TEST_CASE("a take has the bits of its scene, whatever runs it", "[sweep][threads]") {
  const Sweep sweep =
      sweep_of({"sheet.density=3,40", "poke.magnitude*=0.5,2", "sheet.columns=9,11"});
  const int threads = GENERATE(1, 2, 5, 16);
  const Outcomes outcomes = run_all(sweep, {.threads = threads});
  for (const auto& [take, outcome] : outcomes) {
    REQUIRE(outcome.measures);
    Scene edited = poked();
    edited.surfaces[0].material.density = take / 4 == 0 ? 3.0 : 40.0;
    edited.forces[0].magnitude = take / 2 % 2 == 0 ? 450.0 : 1800.0;
    std::get<GridSheet>(edited.surfaces[0].shape).columns = take % 2 == 0 ? 9 : 11;
    CHECK(*outcome.measures == measures_of(edited));
  }
}

TEST_CASE("takes share the samples of a program, and move as by a file",
          "[sweep][cache][threads]") {
  const ScratchFolder folder;
  std::vector<Field> samples;
  for (int k = 0; k < 8; ++k) {
    samples.push_back(sheet_vertices(11));
    samples.back().col(1).array() += 0.05 * k * k;
  }
  Scene base = poked();
  base.forces.push_back(sway());
  base.surfaces[0].cache.samples = ShapeSamples(samples);
  const std::vector<std::string> vary = {"sheet.density=3,40", "sheet.cacheStart=1,2.5"};
  const Outcomes found = run_all(sweep_of(vary, base), {.threads = 3});
  base.surfaces[0].cache = {.path = write_cache(folder, "a.npy", samples)};
  const Outcomes expected = run_all(sweep_of(vary, base));
  for (const auto& [take, outcome] : expected) {
    REQUIRE(outcome.measures);
    CHECK(*found.at(take).measures == *outcome.measures);
  }
  CHECK_FALSE(*expected.at(0).measures == *expected.at(1).measures);
}

TEST_CASE("a take that fails stops nothing", "[sweep][threads]") {
  // c <= -2 sqrt(b d) for some combinations only.
  const Sweep sweep = sweep_of({"sheet.c=-5,2", "sheet.d=1,9"});
  const Outcomes outcomes = run_all(sweep, {.threads = 2});
  CHECK_FALSE(outcomes.at(0).measures);
  CHECK_THAT(outcomes.at(0).measures.error().message, contains_text("c"));
  for (const std::size_t take : {1u, 2u, 3u}) CHECK(outcomes.at(take).measures);
}

TEST_CASE("each value is checked ahead of all takes", "[sweep]") {
  CHECK_THAT(sweep_complaint({"sheet.density=1,-2"}),
             Catch::Matchers::StartsWith("--vary sheet.density=1,-2: ") &&
                 contains_text("must be at least 0"));
  CHECK_THAT(sweep_complaint({"sheet.densty=1"}), contains_text("did you mean \"density\""));
  CHECK_THAT(sweep_complaint({"sheet.density=1,2"}, {"poke.magnitud=1"}),
             Catch::Matchers::StartsWith("--set poke.magnitud=1: "));
  CHECK_THAT(sweep_complaint({"poke.center.x*=1,b"}), contains_text("\"b\""));
}

TEST_CASE("each text is refused as by itself, wherever it stands", "[sweep]") {
  Scene base = poked();
  base.forces[0].magnitude = curve({{1, 0}, {5, 9}});
  ChangeCheck check(base, {});  // one for all: no change may bear on the next
  using Kind = SceneChange::Kind;
  const std::vector<std::string_view> texts = {"1",     "3",    "-3",  "0.5",   "box",
                                               "union", "x",    "",    "1e999", "1 2 3",
                                               "1 2",   "true", "9,9", "poke"};
  for (const SceneChange& change :
       {SceneChange{Kind::Set, "sheet.density"}, SceneChange{Kind::Set, "sheet.columns"},
        SceneChange{Kind::Set, "sheet.combine"}, SceneChange{Kind::Set, "sheet.translate"},
        SceneChange{Kind::Set, "sheet.translate.x"}, SceneChange{Kind::Set, "poke.magnitude"},
        SceneChange{Kind::Times, "poke.magnitude"}, SceneChange{Kind::Plus, "sheet.translate"},
        SceneChange{Kind::Plus, "poke.center.y"}, SceneChange{Kind::Times, "sheet.combine"},
        SceneChange{Kind::Set, "poke.center.progress"}, SceneChange{Kind::Set, "scene.seed"},
        SceneChange{Kind::Set, "poke.targets"}, SceneChange{Kind::Set, "poke.none"}}) {
    for (const std::string_view first : texts) {
      for (const std::string_view second : texts) {
        const std::string_view both[] = {first, second};
        Result<void> wanted;
        std::size_t number = 0;  // of the first that is wrong
        for (const std::string_view text : both) {
          SceneChange one = change;
          one.text = text;
          Scene changed = base;
          if (wanted) wanted = make_changes(changed, std::span(&one, 1));
          if (wanted) ++number;
        }
        const auto wrong = check.first_wrong(change, both, {});
        CAPTURE(change.path, first, second);
        REQUIRE(wrong.has_value() == !wanted.has_value());
        if (!wrong) continue;
        CHECK(wrong->number == number);
        CHECK(wrong->error.message == wanted.error().message);
      }
    }
  }
}

TEST_CASE("frames that the scene lacks are told", "[sweep]") {
  const Takes takes = Takes::make({.vary = {"sheet.density=1"}}).value();
  const auto sweep = Sweep::make({poked()}, takes, {.frames = FrameSpan{2, 9}});
  REQUIRE_FALSE(sweep);
  CHECK_THAT(sweep.error().message, contains_text("--frames 2:9: the scene has frames 1 to 8"));
  // If the frames vary, it fails those takes that lack them.
  const Takes ends = Takes::make({.vary = {"scene.end=8,9"}}).value();
  const Sweep varied = Sweep::make({poked()}, ends, {.frames = FrameSpan{2, 9}}).value();
  const Outcomes outcomes = run_all(varied);
  CHECK_FALSE(outcomes.at(0).measures);
  CHECK(outcomes.at(1).measures);
}

TEST_CASE("memory bounds how many takes run at once, not their results", "[sweep][threads]") {
  const Sweep sweep = sweep_of({"sheet.density=1,2,3,4,5,6"});
  const Outcomes free = run_all(sweep, {.threads = 4});
  const std::size_t one = free.at(0).memory;
  REQUIRE(one > 0);
  // From too little for one to enough for some.
  std::size_t suffices = 0;
  for (std::size_t memory = one / 2; suffices == 0; memory += memory / 4) {
    const Outcomes outcomes = run_all(sweep, {.threads = 4, .max_memory = memory});
    std::size_t done = 0;
    for (const auto& [take, outcome] : outcomes) {
      if (!outcome.measures) {
        CHECK(outcome.measures.error().code == ErrorCode::OutOfMemory);
        continue;
      }
      ++done;
      CHECK(*outcome.measures == *free.at(take).measures);
    }
    CHECK((done == 0 || done == 6));
    if (done == 6) suffices = memory;
    // A simulation by itself fits in the same memory.
    const auto alone = sweep.run(0, {.max_memory = memory}).measures;
    CHECK(alone.has_value() == (done == 6));
  }
  CHECK(suffices < 4 * one);
}

TEST_CASE("takes that are watched end where they are told", "[sweep][threads]") {
  const Sweep sweep = sweep_of({"sheet.density=3,40", "poke.magnitude*=0.5,2"});
  const int threads = GENERATE(1, 3);
  const auto last_of = [](std::size_t take) { return 2 + static_cast<int>(take); };
  std::atomic<int> frames = 0;
  const Outcomes outcomes = run_all(sweep, {.threads = threads,
                                            .watch = [&](std::size_t take, const Simulation&,
                                                         const Frame& frame) -> Result<bool> {
                                              ++frames;
                                              if (take == 3)
                                                return fail(ErrorCode::NotFinite, "seen enough");
                                              return frame.number() < last_of(take);
                                            }});
  CHECK(frames == 2 + 3 + 4 + 1);
  for (std::size_t take = 0; take < 3; ++take) {
    // As if the scene ended there.
    Scene shorter = sweep.scene_of(take).value();
    shorter.end = last_of(take);
    CHECK(outcomes.at(take).measures.value() == measures_of(shorter));
  }
  CHECK(outcomes.at(3).measures.error().message == "seen enough");
}

TEST_CASE("a run ends when asked, and when the caller fails", "[sweep][threads]") {
  const Sweep sweep = sweep_of({"sheet.density=1..40"});
  std::atomic<int> count = 0;
  const auto stopped = sweep.run(all_takes(sweep), {.threads = 2,
                                                    .should_stop = [&] { return count >= 5; },
                                                    .take_done =
                                                        [&](const TakeOutcome& outcome) {
                                                          CHECK(outcome.measures);
                                                          ++count;
                                                          return Result<void>();
                                                        }});
  REQUIRE_FALSE(stopped);
  CHECK(stopped.error().code == ErrorCode::Interrupted);
  CHECK(count < 10);
  count = 0;
  const auto failed = sweep.run(
      all_takes(sweep), {.threads = 2, .take_done = [&](const TakeOutcome&) -> Result<void> {
                           if (++count < 3) return {};
                           return fail(ErrorCode::Unwritable, "full");
                         }});
  REQUIRE_FALSE(failed);
  CHECK(failed.error().message == "full");
  CHECK(count == 3);
}

TEST_CASE("an exception of a force ends the run", "[sweep][threads]") {
  Scene thrower = poked();
  thrower.forces[0].kind =
      CustomForce{.unit_force = [](const Vector3d&, const ForceTime& time) -> Vector3d {
        if (time.frame == 3) throw std::runtime_error("mine");
        return {0, 1, 0};
      }};
  const Sweep sweep = sweep_of({"sheet.density=1..9"}, thrower);
  CHECK_THROWS_AS((void)sweep.run(all_takes(sweep), {.threads = 3}), std::runtime_error);
}

TEST_CASE("a shared shape is that of its own surface", "[sweep]") {
  Shelf shelf(std::size_t{1} << 30U);
  const RunContext context{.shelf = &shelf};
  const SceneOrigin origin;
  Surface surface = sheet("sheet", 9);
  const auto first = find_rest_shape(surface, origin, context).value();
  surface.material.density = 7.0;  // not of the shape
  const auto same = find_rest_shape(surface, origin, context).value();
  CHECK(same.shape.mesh.positions == first.shape.mesh.positions);
  CHECK(same.memory.bytes() == first.memory.bytes());
  std::get<GridSheet>(surface.shape).width = 5;
  const auto other = find_rest_shape(surface, origin, context).value();
  CHECK(other.shape.mesh.positions ==
        make_rest_shape(surface, origin).value().shape.mesh.positions);
  CHECK(other.shape.mesh.positions != first.shape.mesh.positions);
}

TEST_CASE("a mesh file is read once for all takes", "[sweep]") {
  const ScratchFolder folder;
  std::string text;
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 5; ++i) text += "v " + std::to_string(i) + " 0 " + std::to_string(j) + "\n";
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 5; ++i)
      text += "vt " + std::to_string(i / 4.0) + " " + std::to_string(j / 4.0) + "\n";
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      text += "f";
      for (const int corner : {j * 5 + i, j * 5 + i + 1, (j + 1) * 5 + i + 1, (j + 1) * 5 + i})
        text += " " + std::to_string(corner + 1) + "/" + std::to_string(corner + 1);
      text += "\n";
    }
  const auto file = folder.write("mesh.obj", text);
  Surface surface = sheet("mesh");
  surface.shape = MeshFile{.path = file.string()};
  const Sweep sweep = sweep_of({"mesh.density=1,2"}, scene({surface}, {poke("p", {2, 0, 2})}));
  Shelf shelf(std::size_t{1} << 30U);
  const auto first = sweep.run(0, {.shelf = &shelf}).measures;
  REQUIRE(first);
  const std::size_t kept = shelf.kept();
  CHECK(sweep.run(0, {.shelf = &shelf}).measures.value() == *first);
  CHECK(shelf.kept() == kept);
  CHECK(sweep.run(1, {.shelf = &shelf}).measures);
  CHECK(shelf.kept() == kept + 2);  // that another density is sound, and its factor
  std::filesystem::remove(file);
  CHECK_FALSE(sweep.run(1, {.shelf = &shelf}).measures);
}

TEST_CASE("takes share sparse factors, and no bit depends on it", "[sweep][threads]") {
  Surface surface = sheet("sheet", 12);
  surface.shape = make_mesh(std::get<GridSheet>(surface.shape));
  surface.reading.uv = UvReading::Surface;
  surface.solver.region = SolvedRegion::All;
  const auto simulate = [&](double magnitude, Shelf* shelf) {
    auto simulation = Simulation::make(scene({surface}, {poke("poke", {0, 0, 0}, magnitude)}, 5),
                                       {.shelf = shelf})
                          .value();
    Measurer measurer(simulation);
    for (const int frame : simulation.frames()) measurer.add(simulation.at(frame).value());
    return std::pair(measurer.measures().value(), simulation.solver_counts().factorizations);
  };
  Shelf shelf(std::size_t{1} << 30U);
  const auto first = simulate(500, &shelf), second = simulate(900, &shelf),
             alone = simulate(900, nullptr);
  CHECK(first.second == 1);
  CHECK(alone.second == 1);
  CHECK(second.second == 0);
  CHECK(second.first == alone.first);
  CHECK(second.first.hash != first.first.hash);
  const Sweep sweep = sweep_of({"poke.magnitude=900,500,700,900,1100,900"},
                               scene({surface}, {poke("poke", {0, 0, 0})}, 5));
  const Outcomes outcomes = run_all(sweep, {.threads = 3});
  for (const std::size_t take : {0u, 3u, 5u}) CHECK(outcomes.at(take).measures == alone.first);
  CHECK(outcomes.at(1).measures == first.first);
}
