#include "pliant/sweep/takes.hpp"

#include <string>
#include <vector>

#include "pliant/core/text.hpp"
#include "pliant/sweep/sobol.hpp"
#include "pliant/sweep/values.hpp"
#include "support/catch.hpp"

using namespace pliant;
using Catch::Matchers::StartsWith;
using pliant::testing::contains_text;

namespace {

std::vector<std::string> texts_of(const Takes& takes, std::size_t take) {
  const auto texts = takes.texts(take);
  return {texts.begin(), texts.end()};
}

std::string takes_complaint(const SweepVariation& variation) {
  const auto takes = Takes::make(variation);
  REQUIRE_FALSE(takes);
  CHECK(takes.error().code == ErrorCode::InvalidInput);
  return takes.error().message;
}

}  // namespace

TEST_CASE("takes are the product of all axes, the last one fastest", "[sweep][takes]") {
  const Takes takes =
      Takes::make({.scene_count = 2, .vary = {"a.x=1,2,3", "b.y*=4,5", "c.z+=6,7,8,9"}}).value();
  REQUIRE(takes.count() == 2 * 3 * 2 * 4);
  std::size_t take = 0;
  for (std::size_t scene = 0; scene < 2; ++scene)
    for (const std::string x : {"1", "2", "3"})
      for (const std::string y : {"4", "5"})
        for (const std::string z : {"6", "7", "8", "9"}) {
          CHECK(takes.scene_of(take) == scene);
          CHECK(texts_of(takes, take) == std::vector{x, y, z});
          CHECK(takes.changes(take)[1].typed() == "b.y*=" + y);
          ++take;
        }
  CHECK(takes.paths()[1].title() == "b.y*");
  CHECK(takes.paths()[2].title() == "c.z+");
}

TEST_CASE("intervals together are the slowest axis", "[sweep][takes]") {
  const Takes takes =
      Takes::make({.vary = {"a.x=1,2", "b.y=0:10", "c.z=-1:3"}, .samples = 5}).value();
  REQUIRE(takes.count() == 10);
  const std::vector<double> points = sobol_points(2, 0, 5);
  for (std::size_t take = 0; take < 10; ++take) {
    const auto texts = texts_of(takes, take);
    CHECK(texts[0] == (take % 2 == 0 ? "1" : "2"));
    CHECK(to_number(texts[1]) == 10 * points[take / 2 * 2]);
    CHECK(to_number(texts[2]) == -1 + 4 * points[take / 2 * 2 + 1]);
  }
  CHECK(texts_of(takes, 0) == std::vector<std::string>{"1", "5", "1"});  // the centre
}

TEST_CASE("a table has a take in each row", "[sweep][takes]") {
  const Takes takes =
      Takes::make({.set = {"d.w=1"}, .table = "a.x,b.y*\n\"-3 0 0\",2\n1 2 3,3\n"}).value();
  REQUIRE(takes.count() == 2);
  CHECK(texts_of(takes, 0) == std::vector<std::string>{"-3 0 0", "2"});
  CHECK(takes.changes(1)[0].typed() == "d.w=1");
  CHECK(takes.changes(1)[1].typed() == "a.x=1 2 3");
  CHECK(takes.changes(1)[2].typed() == "b.y*=3");
}

TEST_CASE("rows of several scenes are not run on one another's scene", "[sweep][takes]") {
  const std::string both = "scene,a.x\none.xml,1\ntwo.xml,2\n",
                    one = "scene,a.x\none.xml,1\none.xml,2\n";
  for (const std::size_t count : {1, 2})
    CHECK_THAT(takes_complaint({.scene_count = count, .table = both}),
               contains_text("line 1: its rows are of several scenes"));
  CHECK_THAT(takes_complaint({.scene_count = 2, .table = one}), contains_text("several scenes"));
  CHECK(Takes::make({.table = one})->count() == 2);
}

TEST_CASE("blanks round heads and a separator behind the last one are no matter",
          "[sweep][takes]") {
  const Takes takes = Takes::make({.table = " a.x ;b.y* ; take;\n1;2;0;\n3;4;1;\n"}).value();
  CHECK(takes.changes(1)[0].typed() == "a.x=3");
  CHECK(takes.changes(1)[1].typed() == "b.y*=4");
  CHECK(takes.columns_left_out() == std::vector<std::string>{"take"});
}

TEST_CASE("too many takes are refused ahead of making them", "[sweep][takes]") {
  std::vector<std::string> vary;
  for (int k = 0; k < 50; ++k) vary.push_back("a.x" + std::to_string(k) + "=1:2:1000000");
  std::size_t calls = 0;
  const auto takes = Takes::make({.vary = vary}, [&] { return ++calls, false; });
  REQUIRE_FALSE(takes);
  CHECK_THAT(takes.error().message, contains_text("at most 1000000 are allowed"));
  constexpr std::size_t values_between = 256;
  CHECK(calls < 3 * 1'000'000 / values_between);
}

TEST_CASE("a table that may be any file is not quoted", "[sweep][takes]") {
  for (const std::string table :
       {"secret\n1\n", "secret.x,secret.x\n1,2\n", "secret.a.b,secret.a.b\n1,2\n",
        "secret.a.,\n1,2\n", "\"secret\nsecret", "\"secret\"secret,a.b\n", "secret.x\n1,secret\n",
        "secret\nsecret\n", "sep=;secret\nsecret;secret\n"}) {
    CAPTURE(table);
    const std::string complaint = takes_complaint({.table = table, .table_name = "my.csv"});
    CHECK_THAT(complaint, StartsWith("--takes my.csv"));
    CHECK(complaint.find("secret") == std::string::npos);
  }
  CHECK_THAT(takes_complaint({.set = {"secret.x=1"}, .table = "secret.x\n1\n"}),
             contains_text("column 1: --set secret.x=1 sets the same value"));
}

TEST_CASE("takes come back from their plan", "[sweep][takes]") {
  const Takes takes = Takes::make({.vary = {"a.x=1,2", "b.y=0:10"}, .samples = 5}).value();
  const Takes again = Takes::of(takes.plan()).value();
  REQUIRE(again.count() == takes.count());
  for (std::size_t take = 0; take < takes.count(); ++take)
    CHECK(texts_of(again, take) == texts_of(takes, take));
  TakePlan broken = takes.plan();
  broken.axes[0].texts.push_back("1");
  CHECK_FALSE(Takes::of(broken));
  broken = takes.plan();
  broken.axes[0].paths[0] = 7;
  CHECK_FALSE(Takes::of(broken));
  broken = takes.plan();
  broken.axes.pop_back();
  CHECK_FALSE(Takes::of(broken));
}

TEST_CASE("what cannot vary is told with the option", "[sweep][takes]") {
  CHECK_THAT(takes_complaint({}), StartsWith("nothing varies"));
  CHECK_THAT(takes_complaint({.vary = {"a.x"}}), StartsWith("--vary a.x: write PATH=VALUES"));
  CHECK_THAT(takes_complaint({.vary = {"a.x=1,2", "a.x*=1,2"}}),
             StartsWith("--vary a.x*=1,2: a.x varies the same value"));
  CHECK_THAT(takes_complaint({.vary = {"a.v=0 0 0", "a.v.x=1,2"}}),
             contains_text("the same value"));
  CHECK_THAT(takes_complaint({.set = {"a.x=1"}, .vary = {"a.x=1,2"}}),
             StartsWith("--vary a.x=1,2: --set a.x=1 sets the same value"));
  CHECK_THAT(takes_complaint({.vary = {"a.x=0:1"}}), contains_text("needs --sample"));
  CHECK_THAT(takes_complaint({.vary = {"a.x=1"}, .samples = 3}), StartsWith("--sample: no --vary"));
  CHECK_THAT(takes_complaint({.vary = {"a.x=1"}, .table = "b.y\n1\n"}), StartsWith("--takes: "));
  CHECK_THAT(takes_complaint({.table = "b.y\n"}), contains_text("a row a take"));
  CHECK_THAT(takes_complaint({.table = "b.y,c.z\n1,2\n3\n"}), StartsWith("--takes, line 3: has 1"));
  CHECK_THAT(takes_complaint({.table = "b.y,\n1,2\n"}), contains_text("a path is missing"));
  CHECK_THAT(takes_complaint({.table = "take,peak\n1,2\n"}),
             StartsWith("--takes, line 1: no column is headed by a path"));
  // Each message names the file.
  for (const char* table :
       {"b.y\n", "b.y,c.z\n1\n", "b.y,\n1,2\n", "b\n1\n", "b.y,b.y\n1,2\n", "\"b"})
    CHECK_THAT(takes_complaint({.table = table, .table_name = "my.csv"}),
               StartsWith("--takes my.csv"));
  CHECK_THAT(takes_complaint({.vary = {"a.x=1..1000", "b.y=1..1001"}}),
             StartsWith("1001000 takes are too many"));
  std::vector<std::string> many;
  for (std::size_t k = 0; k <= most_intervals; ++k)
    many.push_back("a.x" + std::to_string(k) + "=0:1");
  CHECK_THAT(takes_complaint({.vary = many, .samples = 2}), contains_text("at most 32 intervals"));
}
