#include "pliant/scene/text/text.hpp"

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "support/catch.hpp"

namespace pliant::xml {
namespace {

using pliant::testing::contains_text;

TEST_CASE("a number is read to the last bit", "[scene][text]") {
  struct Row {
    std::string text;
    double number;
  };
  const std::vector<Row> rows = {
      {"0", 0.0},
      {"5", 5.0},
      {"-5", -5.0},
      {"0.1", 0.1},
      {".5", 0.5},
      {"5.", 5.0},
      {"-.25", -0.25},
      {"1e3", 1e3},
      {"1E3", 1e3},
      {"1e+3", 1e3},
      {"2.5e-3", 2.5e-3},
      {"1.7976931348623157e308", 1.7976931348623157e308},
      {" 7 ", 7.0},
      {"\t7\n", 7.0},
      {"0007", 7.0},
      {"5e-324", 5e-324},
      {"0.30000000000000004", 0.30000000000000004},
      {"123456789012345678901234567890", 123456789012345678901234567890.0},
  };
  for (const Row& row : rows) {
    CAPTURE(row.text);
    REQUIRE(parse_number(row.text));
    CHECK(*parse_number(row.text) == row.number);
  }
}

TEST_CASE("what is no number in the C locale is a complaint that says why", "[scene][text]") {
  struct Row {
    std::string text;
    std::string complaint;
  };
  const std::vector<Row> rows = {
      {"", "is empty; one number is required"},
      {"  ", "is empty; one number is required"},
      {"nan", "not a finite number"},
      {"NaN", "not a finite number"},
      {"inf", "not a finite number"},
      {"-infinity", "not a finite number"},
      {"1,5", "\",5\" follows 1 (write the decimal point as \".\")"},
      {"0x10", "\"x10\" follows 0"},
      {"1.5abc", "\"abc\" follows 1.5"},
      {"1e", "\"e\" follows 1"},
      {"1.2.3", "\".3\" follows 1.2"},
      {"1_000", "\"_000\" follows 1"},
      {"5%", "\"%\" follows 5"},
      {"+5", "without the plus sign"},
      {"abc", "not a number"},
      {"-", "not a number"},
      {".", "not a number"},
      {"--5", "not a number"},
      {"1e999", "outside the range"},
      {"-1e999", "outside the range"},
      {"1e-999", "outside the range"},
      {"1 2", "one number is required, not 2"},
      {"\xC2\xA0"
       "5",
       "not a number"},  // a no-break space is not a blank in XML
      {"٣", "not a number"},
  };
  for (const Row& row : rows) {
    CAPTURE(row.text);
    REQUIRE_FALSE(parse_number(row.text));
    CHECK_THAT(parse_number(row.text).error().message, contains_text(row.complaint));
  }
}

TEST_CASE("a vector is as many numbers as asked for, between XML blanks", "[scene][text]") {
  std::array<double, 3> vector{9, 9, 9};
  REQUIRE(parse_numbers(" 1\t2.5\n -3 ", vector));
  CHECK(vector == std::array<double, 3>{1, 2.5, -3});
  for (const std::string text : {"1 2", "1 2 3 4", "", "1 2 x", "1,2,3", "1 2 nan", "1, 2, 3"}) {
    CAPTURE(text);
    CHECK_FALSE(parse_numbers(text, vector));
    CHECK(vector == std::array<double, 3>{1, 2.5, -3});
  }
  CHECK(parse_numbers("1 2", vector).error().message ==
        "three numbers are required, not 2 (separated by spaces)");
  CHECK_THAT(parse_numbers("1 2 x", vector).error().message, contains_text("\"x\": not a number"));
  for (const std::string text :
       {"1,-2.5,3e7", "1, -2.5, 3e7", "(1 -2.5 3e7)", "[1;-2.5; 3e7]", "1 , -2.5 3e7"}) {
    CAPTURE(text);
    CHECK(parse_numbers(text, vector).error().message ==
          "numbers are separated by blanks alone: \"1 -2.5 3e7\"");
  }
  // Commas within the numbers.
  for (const std::string text : {"1,5 2,5 3,5", "1,5 2 3"})
    CHECK_THAT(parse_numbers(text, vector).error().message,
               contains_text("write the decimal point as \".\""));
}

TEST_CASE("an integer has neither point nor exponent and stays in range", "[scene][text]") {
  CHECK(*parse_integer(" -12 ", -100, 100) == -12);
  CHECK(*parse_integer("100", -100, 100) == 100);
  for (const std::string text : {"1.0", "1.5", "1e2", "", "x", "+1", "0x1", "1 2", "101", "-101",
                                 "99999999999999999999", "1,000"}) {
    CAPTURE(text);
    CHECK_FALSE(parse_integer(text, -100, 100));
  }
  CHECK_THAT(parse_integer("1.0", 0, 9).error().message, contains_text("not a whole number"));
  CHECK_THAT(parse_integer("10", 0, 9).error().message, contains_text("at most 9"));
  CHECK_THAT(parse_integer("-1", 0, 9).error().message, contains_text("at least 0"));
}

TEST_CASE("a seed has all 64 bits and no sign", "[scene][text]") {
  CHECK(*parse_natural("18446744073709551615") == std::numeric_limits<std::uint64_t>::max());
  for (const std::string text : {"18446744073709551616", "-1", "1.5", ""}) {
    CAPTURE(text);
    CHECK_FALSE(parse_natural(text));
  }
}

TEST_CASE("a frame rate is a number or the double quotient of a fraction", "[scene][text]") {
  CHECK(*parse_rate("24") == 24.0);
  CHECK(*parse_rate("23.976") == 23.976);
  CHECK(*parse_rate(" 24000/1001 ") == 24000.0 / 1001.0);
  for (const std::string text : {"0", "-24", "24/0", "24/-1", "0/5", "24/", "/1001", "24 / 1",
                                 "1/2/3", "24fps", "nan", "", "1e300/1e-300", "1e-300/1e300"}) {
    CAPTURE(text);
    CHECK_FALSE(parse_rate(text));
  }
}

TEST_CASE("a boolean is true or false", "[scene][text]") {
  CHECK(*parse_boolean("true"));
  CHECK_FALSE(*parse_boolean(" false "));
  for (const std::string text : {"1", "0", "True", "yes", ""}) {
    CAPTURE(text);
    CHECK_FALSE(parse_boolean(text));
  }
}

TEST_CASE("a quoted text fits on one line and is cut between characters", "[scene][text]") {
  CHECK(in_quotes("a\nb\tc") == "\"a b c\"");
  CHECK(in_quotes(std::string(200, 'x')) == '"' + std::string(60, 'x') + "…\"");
  const std::string umlauts = [] {
    std::string text = "x";  // so that byte 60 is the second one of a character
    for (int k = 0; k < 100; ++k) text += "ä";
    return text;
  }();
  CHECK(in_quotes(umlauts) == '"' + umlauts.substr(0, 59) + "…\"");
}

}  // namespace
}  // namespace pliant::xml
