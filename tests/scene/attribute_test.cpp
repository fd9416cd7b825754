#include "pliant/scene/attribute.hpp"

#include <optional>
#include <string>
#include <vector>

#include "support/catch.hpp"

namespace pliant::xml {
namespace {

using pliant::testing::contains_text;

TEST_CASE("a range accepts its ends, or not, and each component counts", "[scene][attribute]") {
  const auto accepts = [](Range range, std::vector<double> numbers) {
    return range.accept(numbers).has_value();
  };
  CHECK(accepts(any_number, {-1e308}));
  CHECK(accepts(not_negative, {0}));
  CHECK(accepts(not_negative, {-0.0}));
  CHECK_FALSE(accepts(not_negative, {-5e-324}));
  CHECK(accepts(positive, {5e-324}));
  CHECK_FALSE(accepts(positive, {0}));
  CHECK(accepts(not_zero, {-1, 1, 2}));
  CHECK_FALSE(accepts(not_zero, {1, 0, 1}));
  CHECK_FALSE(accepts({.least = 0, .most = 1}, {1.5}));
  CHECK(positive.accept(std::vector{-1.0}).error() == "must be greater than 0");
  CHECK(not_zero.accept(std::vector{1.0, 0.0}).error() == "each number must differ from 0");
}

TEST_CASE("a refused value leaves its place as it was", "[scene][attribute]") {
  double width = 3;
  const Attribute row = number("width", width, "length", positive);
  for (const std::string text : {"-1", "0", "x", "", "1 2", "1e999"}) {
    CAPTURE(text);
    CHECK_FALSE(row.read(text));
    CHECK(width == 3);
  }
  REQUIRE(row.read("2.5"));
  CHECK(width == 2.5);
}

TEST_CASE("the default of a row is what its place holds", "[scene][attribute]") {
  double number_place = 0.01;
  int integer_place = 7;
  bool boolean_place = true;
  Channel<3> vector_place = Value<3>{1, 2.5, -3};
  std::optional<Channel<3>> optional_place;
  TangentChannel tangent_place = Channel<3>(Value<3>{0, 1, 0});
  Switch switch_place = false;
  CHECK(number("x", number_place, "s").format.standard == "0.01");
  CHECK(integer("x", integer_place, "", 0, 9).format.standard == "7");
  CHECK(boolean("x", boolean_place).format.standard == "true");
  CHECK(channel("x", vector_place, "").format.standard == "1 2.5 -3");
  CHECK(channel("x", optional_place, "").format.standard.empty());
  CHECK(channel("x", tangent_place, "").format.standard == "0 1 0");
  CHECK(channel("x", switch_place).format.standard == "false");
  CHECK(required(number("x", number_place, "s")).format.standard.empty());
}

TEST_CASE("a tangent takes one number or three", "[scene][attribute]") {
  TangentChannel place = Channel<1>(0);
  const Attribute row = channel("su0", place, "length/uv");
  REQUIRE(row.read("0.5"));
  CHECK(std::get<Channel<1>>(place).at(1) == Value<1>{0.5});
  REQUIRE(row.read("0 2 0"));
  CHECK(std::get<Channel<3>>(place).at(1) == Value<3>{0, 2, 0});
  CHECK(row.read("0 1").error() == "one or three numbers are required");
  CHECK(row.read("").error() == "one or three numbers are required");
  CHECK_THAT(row.read("x").error(), contains_text("not a number"));
  CHECK_THAT(row.read("0 1 x").error(), contains_text("not a number"));
}

TEST_CASE("a word of a later version differs from a misspelt one", "[scene][attribute]") {
  Stepping stepping = Stepping::Exact;
  const Attribute row =
      choice("stepping", stepping, {{"exact", Stepping::Exact}, {"overshoot", Stepping::Overshoot}},
             {"adaptive"});
  CHECK(row.format.standard == "exact");
  REQUIRE(row.read(" overshoot "));
  CHECK(stepping == Stepping::Overshoot);
  CHECK(row.read("adaptive").error() ==
        "is not supported by this version of pliant; allowed: exact, overshoot");
  CHECK(row.read("overshot").error() ==
        "unknown word; did you mean \"overshoot\"? allowed: exact, overshoot");
  CHECK(row.read("Exact").error() ==
        "unknown word; did you mean \"exact\"? allowed: exact, overshoot");
  CHECK(row.read("").error() == "unknown word; allowed: exact, overshoot");
  CHECK(stepping == Stepping::Overshoot);
}

TEST_CASE("a list of names holds each once", "[scene][attribute]") {
  std::vector<std::string> targets;
  const Attribute row = names("targets", targets);
  REQUIRE(row.read(" sheet\n body "));
  CHECK(targets == std::vector<std::string>{"sheet", "body"});
  CHECK_THAT(row.read("").error(), contains_text("leave the attribute out"));
  CHECK_THAT(row.read("sheet,body").error(), contains_text("\"sheet,body\" is not a name"));
  CHECK_THAT(row.read("sheet sheet").error(), contains_text("\"sheet\" is given twice"));
}

}  // namespace
}  // namespace pliant::xml
