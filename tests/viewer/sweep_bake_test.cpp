#include "viewer/sweep_bake.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/scratch_folder.hpp"
#include "viewer/arrays.hpp"
#include "viewer/sweep_table.hpp"
#include "viewer/take_shapes.hpp"

namespace {

using namespace pliant;
using namespace pliant::testing;
using pliant::viewer::Arrays;
using pliant::viewer::bake_sweep;
using pliant::viewer::evenly_spread;
using pliant::viewer::Json;
using pliant::viewer::plan_sweep_view;
using pliant::viewer::table_json;
using pliant::viewer::table_rows;
using pliant::viewer::TakeShapes;

constexpr std::string_view poked = R"(<scene version="1" start="3" end="9">
  <surface name="sheet"><grid columns="9" rows="9" width="8" depth="8"/>
    <transform translate="5 0 0" scale="2 2 2"/></surface>
  <point name="poke" center="5 0 0" deformationRadius="9" forceRadius="4" magnitude="900"/>
</scene>)";

// A sweep of that scene in a folder, whose takes are run.
class RunSweep {
 public:
  explicit RunSweep(const std::vector<std::string>& vary) {
    folder_.write("poked.xml", poked);
    sweep_.emplace(SweepFolder::make(file("sweep"),
                                     {.scenes = {file("poked.xml")}, .variation = {.vary = vary}})
                       .value());
    REQUIRE(sweep_->run({}));
  }

  std::string file(const std::string& name) const { return folder_.file(name).string(); }
  const ScratchFolder& folder() const { return folder_; }
  const SweepFolder& operator*() const { return *sweep_; }
  const SweepFolder* operator->() const { return &*sweep_; }

 private:
  ScratchFolder folder_;
  std::optional<SweepFolder> sweep_;
};

template <class Number>
std::vector<Number> array(const std::string& bytes, const Json& place) {
  std::vector<Number> numbers(place["count"].get<std::size_t>());
  std::memcpy(numbers.data(), bytes.data() + place["begin"].get<std::size_t>(),
              numbers.size() * sizeof(Number));
  return numbers;
}

}  // namespace

TEST_CASE("numbers are spread evenly, with both ends", "[view][sweep]") {
  for (const std::size_t count : {0, 1, 2, 7, 100, 101, 1000, 999'983}) {
    for (const std::size_t most : {1, 2, 3, 100}) {
      CAPTURE(count, most);
      const auto spread = evenly_spread(count, most);
      REQUIRE(spread.size() == std::min(count, most));
      if (spread.empty()) continue;
      CHECK(spread.front() == 0);
      if (spread.size() > 1) CHECK(spread.back() == count - 1);
      for (std::size_t k = 1; k < spread.size(); ++k) {
        const std::size_t step = spread[k] - spread[k - 1];
        CHECK(step >= (count - 1) / (spread.size() - 1));
        CHECK(step <= (count - 1) / (spread.size() - 1) + 1);
      }
    }
  }
}

TEST_CASE("takes that are done are shown, at their peak or at a frame", "[view][sweep]") {
  const RunSweep sweep({"sheet.c=-8,0,1", "poke.magnitude=900,-300"});
  const SweepStatus status = sweep->status().value();
  REQUIRE(status.failed == 2);  // c = -8 gives no stable shape
  const auto plan = plan_sweep_view(*sweep, status, {}).value();
  CHECK(plan.takes == std::vector<std::size_t>{2, 3, 4, 5});
  for (const std::size_t take : plan.takes)
    CHECK(plan.frames.at(take) == status.takes[take].measures.peak_frame);
  CHECK(plan_sweep_view(*sweep, status, 9).value().frames.at(4) == 9);
  for (const int frame : {2, 10}) {
    const auto refused = plan_sweep_view(*sweep, status, frame);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::InvalidInput);
    CHECK(refused.error().message ==
          "--frame " + std::to_string(frame) + ": must be from 3 to 9, those of take 2");
  }
}

TEST_CASE("a frame must be one of each take that is shown", "[view][sweep]") {
  const RunSweep sweep({"scene.end=9,5"});
  const SweepStatus status = sweep->status().value();
  CHECK(plan_sweep_view(*sweep, status, 5));
  const auto refused = plan_sweep_view(*sweep, status, 6);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().message == "--frame 6: must be from 3 to 5, those of take 1");
}

TEST_CASE("the shapes of takes have their peaks", "[view][sweep]") {
  const RunSweep sweep({"poke.magnitude=900,-300,0"});
  const SweepStatus status = sweep->status().value();
  TakeShapes shapes(30);  // of 81 vertices
  for (std::size_t take = 0; take < 3; ++take) {
    const int wanted = status.takes[take].measures.peak_frame;
    const auto outcome = sweep->sweep().run(
        take, {.watch = [&](const Simulation& simulation, const Frame& frame) -> Result<bool> {
          if (frame.number() < wanted) return true;
          if (auto added = shapes.add(take, simulation, frame); !added) return fail(added.error());
          return false;
        }});
    // A take that ends early has the measures of its frames.
    REQUIRE(outcome.measures);
    CHECK(outcome.measures->peak == status.takes[take].measures.peak);
    CHECK(outcome.measures->peak_frame == wanted);
  }
  Arrays arrays;
  const Json json = shapes.finish(arrays);
  CHECK(json["meshes"].size() == 1);  // shared
  REQUIRE(json["takes"].size() == 3);
  for (std::size_t take = 0; take < 3; ++take) {
    const Json& shape = json["takes"][take];
    CHECK(shape["take"] == take);
    CHECK(shape["vertices"] == 81);
    CHECK(shape["shown"].get<int>() <= 30);
    CHECK(shape["shown"].get<int>() >= 9);
    // Of all vertices, those that are not drawn too.
    CHECK(shape["displaced"] == status.takes[take].measures.peak);
    CHECK(shape["low"][0] == -3);  // 5 - 2 * 8 / 2
    CHECK(shape["high"][0] == 13);
  }
}

TEST_CASE("a take whose surface is mirrored has its triangles turned round", "[view][sweep]") {
  const RunSweep sweep({"sheet.scale=2 2 2,-2 2 2"});
  TakeShapes shapes(1000);
  for (const std::size_t take : {0, 1}) {
    const auto outcome = sweep->sweep().run(
        take, {.watch = [&](const Simulation& simulation, const Frame& frame) -> Result<bool> {
          if (auto added = shapes.add(take, simulation, frame); !added) return fail(added.error());
          return false;
        }});
    REQUIRE(outcome.measures);
  }
  Arrays arrays;
  const Json json = shapes.finish(arrays);
  const std::string bytes = arrays.take();
  std::vector<std::vector<std::uint32_t>> meshes;
  for (const std::size_t take : {0, 1}) {
    const std::size_t mesh = json["takes"][take]["mesh"];
    auto triangles = array<std::uint32_t>(bytes, json["meshes"][mesh]);
    for (std::size_t k = 3; k < triangles.size(); ++k) triangles[k] += triangles[k - 3];
    meshes.push_back(std::move(triangles));
  }
  REQUIRE(meshes[0].size() == 3 * 128);
  REQUIRE(meshes[1].size() == meshes[0].size());
  for (std::size_t k = 0; k < meshes[0].size(); k += 3) {
    CHECK(meshes[1][k] == meshes[0][k]);
    CHECK(meshes[1][k + 1] == meshes[0][k + 2]);
    CHECK(meshes[1][k + 2] == meshes[0][k + 1]);
  }
}

TEST_CASE("the table on a page has the numbers of the sweep", "[view][sweep]") {
  const RunSweep sweep({"sheet.c=-8,0.5", "poke.direction=0 1 0,1 0 0"});
  SweepStatus status = sweep->status().value();
  status.takes[3] = {};  // missing
  std::vector<std::size_t> rows(4);
  std::iota(rows.begin(), rows.end(), 0);
  CHECK(table_rows(*sweep, status, {1}) == rows);
  Arrays arrays;
  const Json json = table_json(*sweep, status, rows, arrays);
  const std::string bytes = arrays.take();
  CHECK(array<std::uint32_t>(bytes, json["takes"]) == std::vector<std::uint32_t>{0, 1, 2, 3});
  CHECK(array<char>(bytes, json["status"]) == std::vector<char>{1, 1, 2, 0});
  CHECK(json["paths"][0]["texts"] == Json({"-8", "0.5"}));
  CHECK(json["paths"][1]["texts"] == Json({"0 1 0", "1 0 0"}));
  CHECK(array<std::uint32_t>(bytes, json["paths"][0]["rows"]) ==
        std::vector<std::uint32_t>{0, 0, 1, 1});
  CHECK(array<std::uint32_t>(bytes, json["paths"][1]["rows"]) ==
        std::vector<std::uint32_t>{0, 1, 0, 1});
  const Measures& measures = status.takes[2].measures;
  CHECK(array<double>(bytes, json["peak"])[2] == measures.peak);
  CHECK(array<double>(bytes, json["energy"])[2] == measures.energy);
  CHECK(array<std::int32_t>(bytes, json["settle"])[2] == measures.settle);
  const auto hashes = array<unsigned char>(bytes, json["hash"]);
  std::string digits;
  for (std::size_t k = 32; k < 48; ++k) {
    digits += "0123456789abcdef"[hashes[k] / 16];
    digits += "0123456789abcdef"[hashes[k] % 16];
  }
  CHECK(digits == to_text(measures.hash));
  CHECK(json["errors"]["texts"].size() == 2);  // none, and that of both failures
  CHECK(json["errors"]["texts"][0].get<std::string>().find("c is -8") != std::string::npos);
}

TEST_CASE("a large table is thinned evenly, and keeps the takes that are shown", "[view][sweep]") {
  const ScratchFolder folder;
  folder.write("poked.xml", poked);
  const auto sweep =
      SweepFolder::make(
          folder.file("sweep").string(),
          {.scenes = {folder.file("poked.xml").string()},
           .variation = {.vary = {"sheet.density=1:2", "sheet.damping=1:2"}, .samples = 250'000}})
          .value();
  const SweepStatus status = sweep.status().value();
  const std::vector<std::size_t> needed = {7, 77'777, 249'998};
  const auto rows = table_rows(sweep, status, needed);
  CHECK(rows.size() > 50'000);
  CHECK(rows.size() < 150'000);
  const std::set<std::size_t> all(rows.begin(), rows.end());
  CHECK(all.size() == rows.size());
  for (const std::size_t take : needed) CHECK(all.count(take) == 1);
  std::size_t widest = 0;
  for (std::size_t k = 1; k < rows.size(); ++k) widest = std::max(widest, rows[k] - rows[k - 1]);
  CHECK(widest <= 250'000 / rows.size() + 2);
}

TEST_CASE("a take that cannot be run again is left out and told", "[view][sweep][threads]") {
  const RunSweep sweep({"poke.magnitude=900,-300"});
  SweepStatus status = sweep->status().value();
  const auto plan = plan_sweep_view(*sweep, status, {}).value();
  std::size_t ended = 0;
  const viewer::SweepViewRun run{
      .threads = 2, .max_memory = 1'000'000'000, .take_done = [&] { ++ended; }};
  CHECK(bake_sweep(*sweep, status, plan, run).value().failed.empty());
  CHECK(ended == 2);
  status.takes[1].measures.peak *= 1.5;  // as a broken machine would have written it
  const auto bake = bake_sweep(*sweep, status, plan, run).value();
  CHECK(bake.pictured == 1);
  REQUIRE(bake.failed.count(1) == 1);
  CHECK(bake.failed.at(1).find("as in the table") != std::string::npos);
  const auto stopped =
      bake_sweep(*sweep, status, plan,
                 {.threads = 1, .max_memory = 1'000'000'000, .should_stop = [] { return true; }});
  REQUIRE_FALSE(stopped);
  CHECK(stopped.error().code == ErrorCode::Interrupted);
}
