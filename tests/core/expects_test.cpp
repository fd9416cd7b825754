#include "pliant/core/expects.hpp"

#include <string_view>

#include "support/catch.hpp"
#include "support/last_words.hpp"

TEST_CASE("a broken requirement stops the program and says what it is", "[core][expects]") {
  const auto said =
      pliant::testing::last_words([] { pliant::contract_broken("1 == 2", "file.cpp", 3); });
  CHECK(said.starts_with("file.cpp:3: requirement broken: 1 == 2\n"));
}

TEST_CASE("a requirement that holds does nothing", "[core][expects]") {
  PLIANT_EXPECTS(1 + 1 == 2);
  const auto message = []() -> std::string_view {
    FAIL("not to be made");
    return {};
  };
  PLIANT_EXPECTS_OR(1 + 1 == 2, message());
  SUCCEED();
}
