#include "pliant/sweep/csv.hpp"

#include <random>
#include <string>
#include <vector>

#include "support/catch.hpp"

using namespace pliant;
using Catch::Matchers::StartsWith;

namespace {

using Rows = std::vector<std::vector<std::string>>;

Rows fields_of(std::string_view text) {
  Rows rows;
  const auto parsed = parse_csv(text, 1000);
  REQUIRE(parsed);
  for (const CsvRow& row : *parsed) rows.push_back(row.fields);
  return rows;
}

}  // namespace

TEST_CASE("any fields come back from a table", "[sweep][csv]") {
  std::mt19937 random(GENERATE(range(1, 21)));
  const std::string_view letters = "ab,\"\n\r x";
  Rows rows;
  std::string text;
  for (int row = 0; row < 6; ++row) {
    rows.emplace_back();
    for (int column = 0; column < 3; ++column) {
      std::string field;
      const auto length = std::uniform_int_distribution<int>(1, 6)(random);
      for (int k = 0; k < length; ++k)
        field += letters[std::uniform_int_distribution<std::size_t>(0, letters.size() - 1)(random)];
      rows.back().push_back(field);
      text += (column > 0 ? "," : "") + csv_field(field);
    }
    text += '\n';
  }
  CAPTURE(text);
  CHECK(fields_of(text) == rows);
}

TEST_CASE("tables of other programs are read", "[sweep][csv]") {
  CHECK(fields_of("\xEF\xBB\xBF"
                  "a,b\r\n1,\r\n\r\n,2") == Rows{{"a", "b"}, {"1", ""}, {"", "2"}});
  CHECK(fields_of("\"1 \"\"2\"\"\",\"\"\n") == Rows{{"1 \"2\"", ""}});
  CHECK(fields_of("").empty());
  // The first row tells the separator.
  CHECK(fields_of("\n\r\na;b\n1,5;\"2;3\"\n") == Rows{{"a", "b"}, {"1,5", "2;3"}});
  CHECK(fields_of("a\tb;c\n1\t2,3\n") == Rows{{"a", "b;c"}, {"1", "2,3"}});
  CHECK(fields_of("a;b,c\n1;2,3\n") == Rows{{"a;b", "c"}, {"1;2", "3"}});
  CHECK(fields_of("sep=;\r\na;b,c\n1;2\n") == Rows{{"a", "b,c"}, {"1", "2"}});
  CHECK(parse_csv("sep=,\na,b\n\"1", 3).error().line == 3);
  CHECK(fields_of("sep=").size() == 1);
  CHECK(fields_of("\"a;b\"\n1;2\n") == Rows{{"a;b"}, {"1;2"}});
  CHECK(parse_csv("a\n\"b\nc\"\nd", 3).value()[2].line == 4);
}

TEST_CASE("a broken table is told with its line", "[sweep][csv]") {
  const auto open = parse_csv("a\n\"b\nc", 3);
  REQUIRE_FALSE(open);
  CHECK(open.error().line == 2);
  const auto behind = parse_csv("a\n\"b\"c", 3);
  REQUIRE_FALSE(behind);
  CHECK(behind.error().line == 2);
}

TEST_CASE("a table that is too large is told with its size", "[sweep][csv]") {
  CHECK(parse_csv("a\n1\n\n2\n", 3).value().size() == 3);
  CHECK_THAT(parse_csv("a\n1\n\n2\n3", 3).error().message, StartsWith("4 rows are too many"));
  const std::string wide(most_csv_fields, ',');
  CHECK(parse_csv(wide.substr(1), 1).value()[0].fields.size() == most_csv_fields);
  CHECK_THAT(parse_csv("a\n" + wide, 2).error().message, StartsWith("has more than 10000 values"));
}
