#include <set>
#include <string>
#include <string_view>

#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

namespace {

std::vector<Warning> warnings_of(const Scene& s, int last_frame) {
  auto simulation = Simulation::make(s).value();
  REQUIRE(simulation.at(last_frame));
  return simulation.warnings();
}

}  // namespace

TEST_CASE("a force that selects nothing is a warning about the frames that were played",
          "[feedback][warnings]") {
  Scene s = scene({sheet("a"), sheet("b")}, {poke("f", {0, 0, 0})}, 9);
  s.surfaces[1].transform.translate = Value<3>{100, 0, 0};
  CHECK(warnings_of(s, 9).empty());  // it touches a, and has no named targets

  s.forces[0].targets = {"a", "b"};
  const auto missed = warnings_of(s, 9);
  REQUIRE(missed.size() == 1);
  CHECK_THAT(missed[0].message(), Contains("\"f\" selects no node of \"b\" at frames 1-8:"));
  const auto so_far = warnings_of(s, 8);  // it may still touch a surface later
  REQUIRE(so_far.size() == 1);
  CHECK_THAT(so_far[0].message(), Contains("at frames 1-7, of those that were played:"));
  CHECK(warnings_of(s, 1).empty());  // no frame was solved

  s.forces[0].targets.clear();
  s.forces[0].kind = PointChannels{.center = Value<3>{0, 50, 0}};
  const auto nowhere = warnings_of(s, 9);
  REQUIRE(nowhere.size() == 1);
  CHECK_THAT(nowhere[0].message(), Contains("selects no node of any surface at frames 1-8"));
  s.forces[0].enabled = switch_at({{1, false}, {6, true}});
  CHECK_THAT(warnings_of(s, 9)[0].message(), Contains("at frames 6-8"));
  s.forces[0].enabled = false;
  const auto still = warnings_of(s, 9);  // one for both
  REQUIRE(still.size() == 1);
  CHECK_THAT(still[0].message(), Contains("nothing moved at frames 1-9 of \"a\" and \"b\":") &&
                                     Contains("\"f\" is disabled"));
  s.forces[0].enabled = true;
  s.forces[0].kind =
      PointChannels{.center = vector_curve({{1, {0, 50, 0}}, {7, {0, 50, 0}}, {8, {0, 0, 0}}})};
  CHECK(warnings_of(s, 9).empty());  // it touches a surface at last
}

TEST_CASE("a force box outside the region is a warning, one that reaches out is not",
          "[feedback][warnings]") {
  // The second force selects nothing itself: it pushes nodes of the first one's region.
  Scene s = scene({sheet("a", 41)}, {poke("f", {0, 0, 0}), poke("g", {12, 0, 0})}, 5);
  s.forces[1].deformation_radius = 0;
  const auto outside = warnings_of(s, 5);
  REQUIRE(outside.size() == 2);
  CHECK(outside[0].kind == Warning::Kind::OutsideRegion);
  CHECK_THAT(outside[0].message(),
             Contains("box of \"g\" is outside the region solved on \"a\" at frames 1-4"));
  CHECK(outside[1].kind == Warning::Kind::SelectsNothing);
  s.forces[1].magnitude = 0.0;
  CHECK(warnings_of(s, 5).size() == 1);  // nothing is lost
  s.forces[1] = poke("g", {5, 0, 0});
  s.forces[1].deformation_radius = 0;
  CHECK(warnings_of(s, 5).empty());
}

TEST_CASE("a magnitude that pushes nothing in the whole range is a warning, and the only one",
          "[feedback][warnings]") {
  Scene s = scene({sheet("a")}, {poke("f", {0.5, 0, 0.5})}, 5);
  Force& force = s.forces[0];
  force.targets = {"a"};
  SECTION("a force radius of 0") { force.force_radius = 0.0; }
  SECTION("a force radius below the spacing") { force.force_radius = 0.6; }
  SECTION("no direction") {
    force.kind = PointChannels{.center = Value<3>{0.5, 0, 0.5}, .direction = Value<3>{0, 0, 0}};
  }
  SECTION("only nodes of the rim") {
    force.kind = PointChannels{.center = Value<3>{6, 0, 0.5}};  // on the sheet's own edge
    force.force_radius = 0.6;
  }
  const auto idle = warnings_of(s, 5);
  REQUIRE(idle.size() == 1);
  CHECK(idle[0].kind == Warning::Kind::PushesNothing);
  CHECK_THAT(idle[0].message(),
             Contains("magnitude of \"f\" has no effect on \"a\" at frames 1-4:"));
  REQUIRE(warnings_of(s, 4).size() == 1);
  CHECK_THAT(warnings_of(s, 4)[0].message(), Contains("at frames 1-3, of those that were played:"));
  Scene quiet = s;
  quiet.forces[0].magnitude = 0.0;
  REQUIRE(warnings_of(quiet, 5).size() == 1);
  CHECK_THAT(warnings_of(quiet, 5)[0].message(), Contains("nothing moved") &&
                                                     Contains("of \"a\":") &&
                                                     Contains("magnitude of \"f\" is 0"));
  quiet = s;
  quiet.forces[0].force_radius = curve({{1, 0}, {3, 0}, {4, 3}});
  quiet.forces[0].kind = PointChannels{.center = Value<3>{0.5, 0, 0.5}};
  CHECK(warnings_of(quiet, 5).empty());  // it pushes in the end
  quiet = s;
  quiet.forces[0].deformation_radius = 0.8;  // 2 x 2 nodes: that is the warning
  quiet.forces[0].force_radius = 0.6;
  REQUIRE(warnings_of(quiet, 5).size() == 1);
  CHECK(warnings_of(quiet, 5)[0].kind == Warning::Kind::RegionTooSmall);
}

TEST_CASE("warnings tell of islands each by itself", "[feedback][warnings]") {
  Scene s = scene({sheet("a", 41)}, {poke("f", {-10, 0, 0}), poke("g", {10, 0, 0})}, 4);
  s.surfaces[0].solver.combine = Combine::Islands;
  CHECK(warnings_of(s, 4).empty());
  s.forces[1].deformation_radius = 0.5;  // its island alone is too small
  s.forces[1].force_radius = 0.5;
  const auto small = warnings_of(s, 4);
  REQUIRE(small.size() == 1);
  CHECK(small[0].kind == Warning::Kind::RegionTooSmall);
  CHECK(small[0].force == "g");
  // As a box, the other force's region would contain its nodes; its own island is empty.
  s.forces[1].deformation_radius = 0.0;
  s.forces[1].kind = PointChannels{.center = Value<3>{-8, 0, 0}};
  const auto nothing = warnings_of(s, 4);
  REQUIRE(nothing.size() == 1);
  CHECK(nothing[0].kind == Warning::Kind::SelectsNothing);
  s.surfaces[0].solver.combine = Combine::Box;
  CHECK(warnings_of(s, 4).empty());
}

TEST_CASE("a union tells of what is too small in it", "[feedback][warnings]") {
  Scene s = scene({sheet("a", 41)}, {poke("f", {-10, 0, 0}), poke("g", {10.5, 0, 0.5})}, 4);
  s.surfaces[0].solver.combine = Combine::Union;
  CHECK(warnings_of(s, 4).empty());
  s.forces[1].deformation_radius = 0.8;  // 2 x 2 nodes, far from those of the other force
  s.forces[1].force_radius = 0.8;
  for (const double magnitude : {0.0, 5000.0}) {
    s.forces[1].magnitude = magnitude;
    const auto small = warnings_of(s, 4);
    REQUIRE(small.size() == 1);
    CHECK(small[0].kind == Warning::Kind::RegionTooSmall);
    CHECK(small[0].force == "g");
  }
  s.forces[1].kind = PointChannels{.center = Value<3>{-8.5, 0, 0.5}};  // among them
  CHECK(warnings_of(s, 4).empty());
}

TEST_CASE("a surface that starts behind the end is a warning", "[feedback][warnings]") {
  Scene s = scene({sheet("a"), sheet("b")}, {poke("f", {0, 0, 0})}, 5);
  s.surfaces[1].solver.start_frame = 5;  // the solve at 5 would show at 6
  const auto late = warnings_of(s, 5);
  REQUIRE(late.size() == 1);
  CHECK_THAT(late[0].message(), Contains("surface \"b\" is not solved at frames 1-4"));
  s.surfaces[1].solver.start_frame = 4;
  CHECK(warnings_of(s, 5).empty());
}

TEST_CASE("tangents that no force ever selects are a warning", "[feedback][warnings]") {
  Scene s = scene({sheet("a")}, {}, 5);
  s.surfaces[0].tangents.sv1 = Channel<3>(Value<3>{0, 2, 0});
  const auto unused = warnings_of(s, 5);
  REQUIRE(unused.size() == 1);
  CHECK_THAT(unused[0].message(), Contains("tangents of \"a\" have no effect at frames 1-4"));
  s.forces.push_back(poke("f", {0, 0, 0}, 0));
  CHECK(warnings_of(s, 5).empty());
  s.surfaces[0].enabled = false;
  CHECK(warnings_of(s, 5).empty());  // disabled on purpose
}

TEST_CASE("forces far apart in one box are a warning that names them", "[feedback][warnings]") {
  Scene s =
      scene({sheet("a", 61)},
            {poke("right", {20, 0, 0}), poke("left", {-20, 0, 0}), poke("beside", {-14, 0, 2})}, 6);
  const auto apart = warnings_of(s, 6);
  REQUIRE(apart.size() == 1);
  CHECK(apart[0].kind == Warning::Kind::ForcesApart);
  CHECK(apart[0].surface == "a");
  CHECK_THAT(apart[0].message(), Contains("\"beside\", \"left\" and \"right\" select boxes of "
                                          "\"a\" that do not all meet at frames 1-5:") &&
                                     Contains("combine=\"islands\""));
  for (const Combine combine : {Combine::Islands, Combine::Union}) {
    s.surfaces[0].solver.combine = combine;
    CHECK(warnings_of(s, 6).empty());
  }
  s.surfaces[0].solver.combine = Combine::Box;
  Scene told = s;
  told.origin.parts = {{"a.combine", {0}}};  // combine="box" is given explicitly, so it is intended
  CHECK(warnings_of(told, 6).empty());
  s.forces[0].enabled = switch_at({{1, true}, {4, false}});
  REQUIRE(warnings_of(s, 6).size() == 1);
  CHECK_THAT(warnings_of(s, 6)[0].message(), Contains("at frames 1-3:"));
  // If all boxes meet, here by a group's sphere, none is apart.
  s.forces[0].enabled = true;
  Group hand;
  hand.name = "hand";
  hand.deformation_radius = 40;
  s.groups = {hand};
  CHECK(warnings_of(s, 6).empty());
}

TEST_CASE("boxes that meet by a chain, or once others have met, are not apart",
          "[feedback][warnings]") {
  // Boxes of 9 x 9 nodes. In the scene the chain is given from its ends to its middle.
  Scene s = scene({sheet("a", 61)}, {}, 3);
  for (const double x : {-20.0, 20.0, -13.0, 13.0, 6.0, -6.0, 0.0}) {
    s.forces.push_back(poke("f" + std::to_string(s.forces.size()), {x, 0, 0}));
  }
  CHECK(warnings_of(s, 3).empty());
  s.forces.pop_back();  // the middle of the chain
  const auto apart = warnings_of(s, 3);
  REQUIRE(apart.size() == 1);
  CHECK(apart[0].others.size() == 5);
  // "inside" meets neither of the other two, but the box around both: they would form one island.
  s.forces = {poke("inside", {6, 0, -9}), poke("low", {0, 0, -9}), poke("high", {4, 0, -1})};
  s.forces[0].deformation_radius = s.forces[0].force_radius = 1.5;
  CHECK(warnings_of(s, 3).empty());
  s.forces[0].kind = PointChannels{.center = Value<3>{11, 0, -9}};
  CHECK(warnings_of(s, 3).size() == 1);
}

TEST_CASE("many frames and many names do not make an endless line", "[feedback][warnings]") {
  Warning warning{Warning::Kind::ForcesApart, "sheet", "f0", {}};
  for (int frame = 0; frame < 4000; frame += 2) warning.frames.add(frame);
  for (int k = 1; k < 300; ++k) warning.others.push_back("f" + std::to_string(k));
  CHECK_THAT(warning.message(),
             Contains("\"f0\", \"f1\", \"f2\", \"f3\", \"f4\", \"f5\" and 294 more "
                      "select boxes"));
  CHECK_THAT(warning.message(), Contains("more ranges to 3998"));
  CHECK(warning.message().size() < 500);
  warning.kind = Warning::Kind::LostNodes;
  CHECK(warning.message().size() < 300);
}

TEST_CASE("a group's region is called a group", "[feedback][warnings][group]") {
  Scene s = scene({sheet("a")}, {poke("palm", {0, 0, 0})}, 5);
  Group hand;
  hand.name = "hand";
  hand.center = Value<3>{0, 50, 0};
  s.groups = {hand};
  s.forces[0].group = "hand";
  const auto missed = warnings_of(s, 5);
  REQUIRE(missed.size() == 1);
  CHECK_THAT(missed[0].message(), Contains("group \"hand\" selects no node of any surface"));
  s.groups.clear();
  s.forces[0].group.clear();
  s.forces[0].kind = PointChannels{.center = Value<3>{0, 50, 0}};
  CHECK_THAT(warnings_of(s, 5)[0].message(), Contains("force \"palm\" selects no node"));
}

TEST_CASE("each kind of a warning has a word of its own", "[feedback][warnings]") {
  const int count = static_cast<int>(Warning::Kind::PassesBetween) + 1;
  std::set<std::string_view> words;
  for (int k = 0; k < count; ++k) words.insert(word_of(static_cast<Warning::Kind>(k)));
  CHECK(words.size() == static_cast<std::size_t>(count));
  CHECK_FALSE(words.contains(""));
  CHECK(word_of(Warning::Kind::RegionTooSmall) == "regionTooSmall");
  CHECK(word_of(Warning::Kind::PassesBetween) == "passesBetween");
}
