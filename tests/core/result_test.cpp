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
