#include "pliant/files/json/json_reader.hpp"

#include <string>
#include <utility>
#include <vector>

#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

std::string repeated(std::string_view text, std::size_t count) {
  std::string all;
  for (std::size_t k = 0; k < count; ++k) all += text;
  return all;
}

Error complaint_about(std::string_view text, std::size_t most_values = most_json_values) {
  const auto json = parse_json(text, "a thing", {}, most_values);
  REQUIRE_FALSE(json);
  return json.error();
}

}  // namespace

TEST_CASE("JSON is read as it was written", "[mesh][json]") {
  for (const std::string text :
       {"null", "[]", "{}", "-1", "18446744073709551615", "0.1", R"("\u00e9\n")",
        R"([true,[],[{}],{"a":[1,2.5,"x"],"b":{"a":null}},-7])"}) {
    CAPTURE(text);
    CHECK(*parse_json(text, "a thing") == nlohmann::json::parse(text));
  }
}

TEST_CASE("what is no JSON is told in one line that quotes nothing", "[mesh][json]") {
  const std::vector<std::pair<std::string, int>> cases = {
      {"", 1},
      {"secret", 1},
      {"{\n\"a\":secret}", 2},
      {"[1,\n2,\n", 3},
      {"[1]\nsecret", 2},
      {"[\"\xff secret\"]", 1},
      {"[\"secret\x01\"]", 1},
      {std::string("[1]\0secret", 10), 0},
      {std::string("[\"\0secret\"]", 11), 0},
      {"[1e999]", 0},
      {"{\"secret\":1,\n\"b\":2,\"secret\":3}", 2},
      {repeated("[", 1'000'000), 0},
      {repeated("{\"a\":", 1'000'000), 0}};
  for (const auto& [text, line] : cases) {
    CAPTURE(text.substr(0, 40));
    const Error error = complaint_about(text);
    CHECK(error.code == ErrorCode::InvalidInput);
    CHECK(error.line == line);
    CHECK(error.message.find("secret") == std::string::npos);
    CHECK(error.message == printable(error.message));
    CHECK(error.message.size() < 100);
  }
  CHECK(parse_json(std::string("[1]\0\0", 5), "a thing"));  // some writers fill up so
}

TEST_CASE("depth and number of values are limited exactly", "[mesh][json]") {
  CHECK(parse_json(repeated("[", deepest_json) + repeated("]", deepest_json), "a thing"));
  CHECK_THAT(
      complaint_about(repeated("[", deepest_json + 1) + repeated("]", deepest_json + 1)).message,
      contains_text("nested more than 200 deep"));
  for (const std::string text : {"[1,2,3]", R"({"a":1,"b":[2]})", "[[],[],[]]"}) {
    CAPTURE(text);
    CHECK(parse_json(text, "a thing", {}, 4));
    CHECK_THAT(complaint_about(text, 3).message, contains_text("has more than 3 values"));
  }
}

TEST_CASE("texts of lists can be taken while they are parsed", "[mesh][json]") {
  std::vector<std::string> taken;
  const TakeJsonText take = [&](std::span<const JsonStep> way,
                                const std::string& text) -> Result<bool> {
    if (text == "no") return invalid("not this one");
    if (way.size() != 3 || way[0].key != "a" || !way[1].is_list || way[2].is_list != true)
      return false;
    taken.push_back(std::to_string(way[1].index) + std::to_string(way[2].index) + text);
    return true;
  };
  const auto json =
      parse_json(R"({"b":["p"],"a":[["q","r"],7,["s",1,"t"],"u"]})", "a thing", {}, 100, take);
  REQUIRE(json);
  CHECK(*json == nlohmann::json::parse(R"({"b":["p"],"a":[[],7,[1],"u"]})"));
  CHECK(taken == std::vector<std::string>{"00q", "01r", "20s", "22t"});
  const auto refused = parse_json(R"({"a":[["no"]]})", "a thing", {}, 100, take);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().message == "not this one");
}

TEST_CASE("parsing JSON ends when asked, also within one long text", "[mesh][json]") {
  for (const std::string& text :
       {"[" + repeated("1,", 2'000'000) + "1]", "[\"" + std::string(4'000'000, 'x') + "\"]"}) {
    std::size_t calls = 0;
    const auto parse = [&](std::size_t last) {
      calls = 0;
      return parse_json(text, "a thing", [&] { return ++calls >= last; });
    };
    REQUIRE(parse(SIZE_MAX));
    const std::size_t all = calls;
    CHECK(all >= text.size() / StopPoll::parts_between);
    for (const std::size_t last : {std::size_t{1}, all / 2, all}) {
      const auto parsed = parse(last);
      REQUIRE_FALSE(parsed);
      CHECK(parsed.error().code == ErrorCode::Interrupted);
      CHECK(calls == last);
    }
  }
}
