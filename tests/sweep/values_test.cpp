#include "pliant/sweep/values.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "pliant/core/text.hpp"
#include "support/catch.hpp"

using namespace pliant;
using pliant::testing::contains_text;
using pliant::testing::WithinRel;

namespace {

using Texts = std::vector<std::string>;

Texts axis_texts(std::string_view text) {
  const auto values = parse_axis_values(text);
  REQUIRE(values);
  return values->texts;
}

std::string axis_complaint(std::string_view text) {
  const auto values = parse_axis_values(text);
  REQUIRE_FALSE(values);
  return values.error().message;
}

}  // namespace

TEST_CASE("a list is its texts", "[sweep][values]") {
  CHECK(axis_texts("1,0.50, 2") == Texts{"1", "0.50", "2"});
  CHECK(axis_texts("-3 0 0,3 0 0") == Texts{"-3 0 0", "3 0 0"});
  CHECK(axis_texts("box") == Texts{"box"});
  CHECK(axis_texts("a:b.obj,c:d.obj") == Texts{"a:b.obj", "c:d.obj"});
  CHECK(axis_texts("1.5..2") == Texts{"1.5..2"});
}

TEST_CASE("numbers from A to B are those of the formula", "[sweep][values]") {
  const auto [a, b] = GENERATE(table<double, double>({{0, 1}, {5, -3}, {0.1, 0.7}, {1e-9, 1e9}}));
  const int count = GENERATE(2, 3, 7, 100);
  const Texts texts = axis_texts(fmt::format("{}:{}:{}", a, b, count));
  REQUIRE(texts.size() == static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    const double wanted = k == count - 1 ? b : a + (b - a) * k / (count - 1);
    CHECK(to_number(texts[static_cast<std::size_t>(k)]) == wanted);
  }
}

TEST_CASE("one number from A to B is A, and texts are the shortest", "[sweep][values]") {
  CHECK(axis_texts("3:9:1") == Texts{"3"});
  CHECK(axis_texts("0:1:11")[3] == "0.3");
  CHECK(axis_texts("0:0.3:4") == Texts{"0", "0.09999999999999999", "0.19999999999999998", "0.3"});
}

TEST_CASE("numbers in the logarithm have one ratio, and exact ends", "[sweep][values]") {
  const double sign = GENERATE(1.0, -1.0);
  const Texts texts = axis_texts(fmt::format("{}:{}:7:log", sign * 0.1, sign * 100));
  REQUIRE(texts.size() == 7);
  CHECK(to_number(texts.front()) == sign * 0.1);
  CHECK(to_number(texts.back()) == sign * 100);
  for (std::size_t k = 1; k < texts.size(); ++k)
    CHECK_THAT(*to_number(texts[k]) / *to_number(texts[k - 1]),
               WithinRel(std::pow(1000.0, 1.0 / 6), 1e-14));  // a few ulps of exp
}

TEST_CASE("integers and intervals", "[sweep][values]") {
  CHECK(axis_texts("3..6") == Texts{"3", "4", "5", "6"});
  CHECK(axis_texts("-1..-1") == Texts{"-1"});
  CHECK(axis_texts("1..1000000").size() == 1'000'000);
  const auto interval = parse_axis_values("0.5:2").value();
  CHECK(interval.is_interval());
  CHECK(interval.from == 0.5);
  CHECK(interval.to == 2);
}

TEST_CASE("wrong values are told", "[sweep][values]") {
  CHECK_THAT(axis_complaint("1,,2"), contains_text("value 2 of the list is empty"));
  CHECK_THAT(axis_complaint(""), contains_text("empty"));
  CHECK_THAT(axis_complaint("6..3"), contains_text("must not be less than the first"));
  CHECK_THAT(axis_complaint("0..1000000"), contains_text("more than 1000000 values"));
  CHECK_THAT(axis_complaint("0:1:0"), contains_text("not a count of values"));
  CHECK_THAT(axis_complaint("0:1:2.5"), contains_text("not a count of values"));
  CHECK_THAT(axis_complaint("0:1:9999999"), contains_text("not a count of values"));
  CHECK_THAT(axis_complaint("0:1:3:log"), contains_text("one sign"));
  CHECK_THAT(axis_complaint("-1:1:3:log"), contains_text("one sign"));
  CHECK_THAT(axis_complaint("1:2:3:lag"), contains_text("no way to divide"));
  CHECK_THAT(axis_complaint("-1e308:1e308:4"), contains_text("not all finite"));
}
