#include "pliant/core/result.hpp"

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("an error and those found with it take one line each", "[core][result]") {
  Error error = fail(ErrorCode::InvalidInput, "first", "scene.xml", 14).value();
  error.others.push_back({ErrorCode::InvalidInput, "second", "scene.xml", 0, {}});
  error.others.push_back({ErrorCode::InvalidInput, "third", "", 7, {}});
  CHECK(to_lines(error) == std::vector<std::string>{"scene.xml:14: error: first",
                                                    "scene.xml: error: second", "error: third"});
}

TEST_CASE("what a file wrote does not break a line", "[core][result]") {
  const Error error = fail(ErrorCode::InvalidInput, "no \x1b[31m\xc3\xa4", "a\nb.obj", 2).value();
  CHECK(to_lines(error) == std::vector<std::string>{"a\\x0ab.obj:2: error: no \\x1b[31m\xc3\xa4"});
}

TEST_CASE("what acts on a terminal or is no UTF-8 is told by its bytes", "[core][result]") {
  CHECK(printable("a\nb\x7f") == "a\\x0ab\\x7f");
  CHECK(printable(std::string_view("\0", 1)) == "\\x00");
  CHECK(printable("\xc2\x9b[2J") == "\\xc2\\x9b[2J");               // CSI as one character
  CHECK(printable("a\xe2\x80\xae.exe") == "a\\xe2\\x80\\xae.exe");  // right to left from here on
  CHECK(printable("\xe2\x80\xa8") == "\\xe2\\x80\\xa8");            // line separator
  for (const char* sound : {"", "plain", "ü", "日本", "🌊", "\xc2\xa0", "\xef\xbf\xbd"})
    CHECK(printable(sound) == sound);
  // Truncated, without a start, overlong, a surrogate, beyond the last code point.
  CHECK(printable("\xc3") == "\\xc3");
  CHECK(printable("\x9b\xc3z") == "\\x9b\\xc3z");
  CHECK(printable("\xc0\x8a") == "\\xc0\\x8a");
  CHECK(printable("\xe0\x80\x8a") == "\\xe0\\x80\\x8a");
  CHECK(printable("\xed\xa0\x80") == "\\xed\\xa0\\x80");
  CHECK(printable("\xf4\x90\x80\x80") == "\\xf4\\x90\\x80\\x80");
  CHECK(printable("\xf0\x9f\x8c") == "\\xf0\\x9f\\x8c");
  CHECK(printable(printable("\x1b\xff")) == printable("\x1b\xff"));
}
