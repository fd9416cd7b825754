#include "pliant/scene/text/line_map.hpp"

#include "support/catch.hpp"

namespace pliant::testing {
namespace {

TEST_CASE("a map of lines tells file, line and chain", "[scene][line_map]") {
  LineMap map("shot.xml");
  CHECK(map.place_of(7).file == "shot.xml");
  CHECK(map.place_of(7).line == 7);
  const int rig = map.add_text("rig.xml", 0, 3);
  map.add_run(4, rig, 2);
  const int force = map.add_text("force.xml", rig, 5);
  map.add_run(8, force, 1);
  map.add_run(9, rig, 5);
  map.add_run(11, 0, 3);
  struct Row {
    int line, text, there;
    std::string file, chain;
  };
  const Row rows[] = {{1, 0, 1, "shot.xml", ""},
                      {3, 0, 3, "shot.xml", ""},
                      {4, 1, 2, "rig.xml", "included by shot.xml:3"},
                      {7, 1, 5, "rig.xml", "included by shot.xml:3"},
                      {8, 2, 1, "force.xml", "included by rig.xml:5, by shot.xml:3"},
                      {9, 1, 5, "rig.xml", "included by shot.xml:3"},
                      {11, 0, 3, "shot.xml", ""},
                      {20, 0, 12, "shot.xml", ""}};
  for (const Row& row : rows) {
    CAPTURE(row.line);
    const ScenePlace place = map.place_of(row.line);
    CHECK(map.text_of(row.line) == row.text);
    CHECK(place.file == row.file);
    CHECK(place.line == row.there);
    CHECK(place.chain == row.chain);
  }
  CHECK(map.place_of(0).line == 0);
  CHECK(map.place_of(0).file == "shot.xml");
  CHECK(map.title_of(2, 12) == "line 2");
  CHECK(map.title_of(4, 10) == "line 2");
  CHECK(map.title_of(2, 4) == "line 2 of shot.xml");
  CHECK(map.title_of(8, 1) == "line 1 of force.xml, included by rig.xml:5, by shot.xml:3");
  CHECK(map.place_of(8).told("bad") == "bad; included by rig.xml:5, by shot.xml:3");
  CHECK(map.place_of(1).told("bad") == "bad");
}

TEST_CASE("names of files in a chain stay on one line", "[scene][line_map]") {
  LineMap map("a\nb.xml");
  map.add_run(2, map.add_text("c.xml", 0, 1), 1);
  CHECK(map.place_of(2).chain == "included by a\\x0ab.xml:1");
}

}  // namespace
}  // namespace pliant::testing
