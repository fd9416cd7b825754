#include "pliant/core/result.hpp"

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("an error and those found with it take one line each", "[core][result]") {
  Error error{ErrorCode::InvalidInput, "first", "scene.xml", 14, {}};
  error.others.push_back({ErrorCode::InvalidInput, "second", "scene.xml", 0, {}});
  error.others.push_back({ErrorCode::InvalidInput, "third", "", 7, {}});
  CHECK(to_lines(error) == std::vector<std::string>{"scene.xml:14: error: first",
                                                    "scene.xml: error: second", "error: third"});
}

TEST_CASE("what a file wrote does not break a line", "[core][result]") {
  const Error error{ErrorCode::InvalidInput, "no \x1b[31m\xc3\xa4", "a\nb.obj", 2, {}};
  CHECK(to_lines(error) == std::vector<std::string>{"a\\x0ab.obj:2: error: no \\x1b[31m\xc3\xa4"});
}
