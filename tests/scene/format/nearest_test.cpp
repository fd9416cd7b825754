#include "pliant/scene/format/nearest.hpp"

#include <string>
#include <vector>

#include "support/catch.hpp"

namespace pliant::xml {
namespace {

const std::vector<std::string_view> words = {"name",   "magnitude",  "falloff", "center",
                                             "from",   "to",         "b",       "deformationRadius",
                                             "bounce", "forceRadius"};

TEST_CASE("the nearest word is the one with the fewest slips", "[scene][nearest]") {
  struct Row {
    std::string written;
    std::string_view meant;
  };
  const std::vector<Row> rows = {
      {"falof", "falloff"},
      {"fallof", "falloff"},
      {"Falloff", "falloff"},
      {"centre", "center"},
      {"magnitde", "magnitude"},
      {"form", "from"},
      {"B", "b"},
      {"nmae", "name"},
      {"deformationradius", "deformationRadius"},
      {"forceRadus", "forceRadius"},
  };
  for (const Row& row : rows) {
    CAPTURE(row.written);
    CHECK(nearest_word(row.written, words) == row.meant);
  }
}

TEST_CASE("a word that is far from all is not guessed", "[scene][nearest]") {
  for (const std::string written : {"", "x", "q", "velocity", "abcdefgh", "tt"}) {
    CAPTURE(written);
    CHECK_FALSE(nearest_word(written, words));
  }
  CHECK_FALSE(nearest_word(std::string(100'000, 'b'), words));
  CHECK_FALSE(nearest_word("name", {}));
}

TEST_CASE("a hint asks only when there is a guess and lists what is allowed", "[scene][nearest]") {
  const std::vector<std::string_view> allowed = {"box", "sphere"};
  CHECK(hint("bxo", allowed) == "; did you mean \"box\"? allowed: box, sphere");
  CHECK(hint("cylinder", allowed) == "; allowed: box, sphere");
  CHECK(hint("box", {}) == "; allowed: none");
  const std::vector<std::string_view> many(100, "word");
  CHECK_THAT(hint("x", many), Catch::Matchers::EndsWith(", …"));
}

}  // namespace
}  // namespace pliant::xml
