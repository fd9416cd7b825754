#include "pliant/feedback/warning_log.hpp"

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "support/catch.hpp"

using namespace pliant;
using Catch::Matchers::Contains;
using enum Warning::Kind;

namespace {

std::vector<std::string> messages(const WarningLog& log, const Scene& scene = {}) {
  std::vector<std::string> result;
  for (const Warning& warning : log.warnings(scene, true)) result.push_back(warning.message());
  return result;
}

Surface surface_named(const std::string& name) {
  Surface surface;
  surface.name = name;
  return surface;
}

}  // namespace

TEST_CASE("warnings come once a cause, with all its frames", "[feedback][warnings]") {
  WarningLog log;
  for (const int frame : {7, 5, 6, 9}) log.add(Warning::Kind::LostNodes, "sheet", "poke", frame);
  log.add(Warning::Kind::RegionTooSmall, "sheet", "poke", 2);
  log.add(Warning::Kind::LostNodes, "sheet", "other", 7);
  const auto warnings = log.warnings(Scene(), false);
  REQUIRE(warnings.size() == 3);
  CHECK_THAT(
      warnings[0].message(),
      Contains("\"poke\" selects fewer than 3 x 3 nodes of \"sheet\"") && Contains("at frame 2"));
  CHECK_THAT(warnings[1].message(),
             Contains("\"other\" lost its own nodes on \"sheet\" at frame 7:"));
  CHECK_THAT(warnings[2].message(),
             Contains("\"poke\" lost its own nodes") && Contains("at frames 5-7, 9"));
}

TEST_CASE("what never happened is told of the frames so far", "[feedback][warnings]") {
  WarningLog log;
  using enum Warning::Kind;
  for (const int frame : {1, 2, 3}) {
    log.expect(SelectsNothing, "sheet", "poke", frame);
    log.expect(SelectsNothing, "", "other", frame);
  }
  log.happened(SelectsNothing, "", "other");
  log.add(LostNodes, "sheet", "poke", 2);  // happened, whatever other frames bring
  for (const bool is_complete : {false, true}) {
    const std::vector<Warning> warnings = log.warnings(Scene(), is_complete);
    REQUIRE(warnings.size() == 2);
    CHECK_FALSE(warnings[0].is_of_part);
    CHECK(warnings[1].is_of_part == !is_complete);
    CHECK_THAT(warnings[1].message(),
               Contains("\"poke\" selects no node of \"sheet\" at frames 1-3" +
                        std::string(is_complete ? ":" : ", of those that were played:")));
  }
}

TEST_CASE("warnings do not depend on the order of what is noted", "[feedback][warnings]") {
  std::vector<void (*)(WarningLog&)> notes = {
      [](WarningLog& log) { log.add(LostNodes, "a", "f", 3); },
      [](WarningLog& log) { log.add(LostNodes, "a", "f", 4); },
      [](WarningLog& log) { log.add(LostNodes, "b", "f", 4); },
      [](WarningLog& log) { log.add(RegionTooSmall, "a", "g", 9); },
      [](WarningLog& log) { log.expect(PushesNothing, "a", "f", 2); },
      [](WarningLog& log) { log.expect(PushesNothing, "a", "f", 7); },
      [](WarningLog& log) { log.happened(PushesNothing, "a", "f"); },
      [](WarningLog& log) { log.expect(PushesNothing, "b", "f", 2); },
      [](WarningLog& log) { log.happened(SelectsNothing, "b", "f"); },  // something else
      [](WarningLog& log) { log.add(ForcesApart, "a", "g", 5); },
      [](WarningLog& log) { log.add(ForcesApart, "a", "f", 6); },
      [](WarningLog& log) { log.add(ForcesApart, "b", "f", 6); }};
  const auto told = [&] {
    WarningLog log;
    for (const auto& note : notes) note(log);
    return messages(log);
  };
  const std::vector<std::string> expected = told();
  CHECK(expected.size() == 6);
  std::mt19937 random(1);
  for (int trial = 0; trial < 50; ++trial) {
    std::shuffle(notes.begin(), notes.end(), random);
    CHECK(told() == expected);
  }
}

TEST_CASE("forces that are apart on a surface are told together, unless it is intended",
          "[feedback][warnings]") {
  WarningLog log;
  log.add(ForcesApart, "a", "f", 3);
  log.add(ForcesApart, "a", "g", 5);
  log.add(ForcesApart, "b", "f", 8);
  Scene scene;
  const std::vector<Warning> warnings = log.warnings(scene, false);
  REQUIRE(warnings.size() == 2);
  CHECK(warnings[0].force == "f");
  CHECK(warnings[0].others == std::vector<std::string>{"g"});
  CHECK(warnings[0].frames.to_string() == "3, 5");
  CHECK(warnings[1].surface == "b");
  scene.origin.parts = {{"a.combine", {0}}};
  REQUIRE(log.warnings(scene, false).size() == 1);
  CHECK(log.warnings(scene, false)[0].surface == "b");
}

TEST_CASE("what a force does on one of its surfaces is enough if it has no targets",
          "[feedback][warnings]") {
  const std::vector<std::string> targets = {"a", "b"};
  const bool has_targets = GENERATE(false, true);
  SurfaceInputs inputs;
  inputs.sources = {{.name = "f", .kind = "point", .targets = {}}};
  if (has_targets) inputs.sources[0].targets = targets;
  StepFacts touching, missing;
  touching.forces = {{.touches = true}};
  missing.forces = {{}};
  WarningLog log;
  add_facts(log, surface_named("a"), 1, inputs, touching);
  add_facts(log, surface_named("b"), 1, inputs, missing);
  const std::vector<Warning> warnings = log.warnings({}, true);
  REQUIRE(warnings.size() == (has_targets ? 1 : 0));
  if (has_targets) {
    CHECK(warnings[0].kind == SelectsNothing);
    CHECK(warnings[0].surface == "b");
  }
  CHECK(log.warnings({}, false).size() == warnings.size());
}

TEST_CASE("facts of a surface of triangles have warnings of their own", "[feedback][warnings]") {
  SurfaceInputs inputs;
  inputs.sources = {{.name = "f", .kind = "point", .targets = {}, .selects = false}};
  StepFacts facts;
  facts.forces = {{.is_too_small = true}};
  const auto kind_of = [&] {
    WarningLog log;
    add_facts(log, surface_named("a"), 1, inputs, facts);
    REQUIRE(log.warnings({}, true).size() == 1);
    return log.warnings({}, true)[0].kind;
  };
  CHECK(kind_of() == RegionTooSmall);
  facts.is_surface = true;
  CHECK(kind_of() == AllHeld);
  facts.forces = {{.is_between_nodes = true}};
  CHECK(kind_of() == BetweenNodes);
  facts.forces = {{}};
  facts.has_loose_patch = true;
  CHECK(kind_of() == LoosePatch);
}
