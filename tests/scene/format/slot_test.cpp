#include "pliant/scene/format/slot.hpp"

#include <optional>
#include <string>
#include <vector>

#include "support/catch.hpp"

namespace pliant::xml {
namespace {

using pliant::testing::contains_text;

TEST_CASE("a range accepts its ends, or not, and each component counts", "[scene][slot]") {
  const auto accepts = [](Range range, std::vector<double> numbers) {
    return !range.broken_rule(numbers);
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
  CHECK(positive.broken_rule(std::vector{-1.0}) == "must be greater than 0");
  CHECK(a_share.broken_rule(std::vector{1.5}) == "must be from 0 to 1");
  CHECK(not_zero.broken_rule(std::vector{1.0, 0.0}) == "each number must differ from 0");
}

TEST_CASE("a refused value leaves its place as it was", "[scene][slot]") {
  double width = 3;
  const Slot row = slot({.name = "width", .range = positive}, &width);
  for (const std::string text : {"-1", "0", "x", "", "1 2", "1e999"}) {
    CAPTURE(text);
    CHECK_FALSE(row.read(text));
    CHECK(width == 3);
  }
  REQUIRE(row.read("2.5"));
  CHECK(width == 2.5);
}

TEST_CASE("the default of a row is what its place holds", "[scene][slot]") {
  double number_place = 0.01;
  int integer_place = 7;
  bool boolean_place = true;
  Channel<3> vector_place = Value<3>{1, 2.5, -3};
  std::optional<Channel<3>> optional_place;
  TangentChannel tangent_place = Channel<3>(Value<3>{0, 1, 0});
  Switch switch_place = false;
  CHECK(slot({}, &number_place).text == "0.01");
  CHECK(slot({}, &integer_place).text == "7");
  CHECK(slot({}, &boolean_place).text == "true");
  CHECK(slot({}, &vector_place).text == "1 2.5 -3");
  CHECK(slot({}, &optional_place).text.empty());
  CHECK(slot({}, &tangent_place).text == "0 1 0");
  CHECK(slot({}, &switch_place).text == "false");
  CHECK(format_of(slot({.need = Need::Required}, &number_place)).standard.empty());
  CHECK(format_of(slot({.absent = "none"}, &optional_place)).standard == "(none)");
}

TEST_CASE("a tangent takes one number or three", "[scene][slot]") {
  TangentChannel place = Channel<1>(0);
  const Slot row = slot({.name = "su0"}, &place);
  REQUIRE(row.read("0.5"));
  CHECK(std::get<Channel<1>>(place).at(1) == Value<1>{0.5});
  REQUIRE(row.read("0 2 0"));
  CHECK(std::get<Channel<3>>(place).at(1) == Value<3>{0, 2, 0});
  CHECK(row.read("0 1").error().message == "one or three numbers are required");
  CHECK(row.read("").error().message == "one or three numbers are required");
  CHECK_THAT(row.read("x").error().message, contains_text("not a number"));
  CHECK_THAT(row.read("0 1 x").error().message, contains_text("not a number"));
}

TEST_CASE("a word of a later version differs from a misspelt one", "[scene][slot]") {
  constexpr std::string_view later[] = {"adaptive"};
  Stepping stepping = Stepping::Exact;
  const Slot row =
      slot({.name = "stepping", .words = stepping_words, .later = later}, choice(stepping));
  CHECK(row.text == "exact");
  REQUIRE(row.read(" overshoot "));
  CHECK(stepping == Stepping::Overshoot);
  CHECK(row.read("adaptive").error().message ==
        "is not supported by this version of pliant; allowed: exact, overshoot");
  CHECK(row.read("overshot").error().message ==
        "unknown word; did you mean \"overshoot\"? allowed: exact, overshoot");
  CHECK(row.read("Exact").error().message ==
        "unknown word; did you mean \"exact\"? allowed: exact, overshoot");
  CHECK(row.read("").error().message == "unknown word; allowed: exact, overshoot");
  CHECK(stepping == Stepping::Overshoot);
}

TEST_CASE("a list of names holds each once", "[scene][slot]") {
  std::vector<std::string> targets;
  const Slot row = slot(targets_attribute, &targets);
  REQUIRE(row.read(" sheet\n body "));
  CHECK(targets == std::vector<std::string>{"sheet", "body"});
  CHECK_THAT(row.read("").error().message, contains_text("leave the attribute out"));
  CHECK_THAT(row.read("sheet,body").error().message, contains_text("\"sheet,body\" is not a name"));
  CHECK_THAT(row.read("sheet sheet").error().message, contains_text("\"sheet\" is given twice"));
}

}  // namespace
}  // namespace pliant::xml
