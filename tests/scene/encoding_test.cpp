#include "pliant/scene/encoding.hpp"

#include <string>
#include <string_view>
#include <vector>

#include "support/catch.hpp"

namespace pliant::xml {
namespace {

using pliant::testing::contains_text;

using namespace std::string_view_literals;

TEST_CASE("UTF-8 of every length is sound", "[scene][encoding]") {
  for (const std::string_view text :
       {""sv, "plain\t\r\n"sv, "ä€😀"sv, "\xC2\x80"sv, "\xDF\xBF"sv, "\xE0\xA0\x80"sv,
        "\xED\x9F\xBF"sv, "\xEE\x80\x80"sv, "\xF0\x90\x80\x80"sv, "\xF4\x8F\xBF\xBF"sv}) {
    CAPTURE(text);
    CHECK_FALSE(find_encoding_fault(text));
  }
}

TEST_CASE("the first byte that is no UTF-8 or no XML is found", "[scene][encoding]") {
  for (const std::string_view bad :
       {"\0"sv, "\x01"sv, "\x1F"sv, "\x80"sv, "\xBF"sv, "\xC0\x80"sv, "\xC1\xBF"sv, "\xC3"sv,
        "\xC3("sv, "\xE0\x9F\xBF"sv, "\xE2\x82"sv, "\xED\xA0\x80"sv, "\xF0\x8F\xBF\xBF"sv,
        "\xF0\x9F\x98"sv, "\xF4\x90\x80\x80"sv, "\xF5\x80\x80\x80"sv, "\xFF"sv}) {
    const std::string text = "abc" + std::string(bad);
    CAPTURE(text);
    REQUIRE(find_encoding_fault(text));
    CHECK(find_encoding_fault(text)->at == 3);
  }
  CHECK_THAT(find_encoding_fault("\xFF\xFE<\0"sv)->message, contains_text("UTF-16"));
  CHECK_THAT(find_encoding_fault("\0"sv)->message, contains_text("NUL"));
}

}  // namespace
}  // namespace pliant::xml
