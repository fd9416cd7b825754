#include "pliant/core/trim.hpp"

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("trimming takes blanks from the ends only", "[core][trim]") {
  CHECK(trim(" \ta b\t ", " \t") == "a b");
  CHECK(trim("a", " ") == "a");
  CHECK(trim(" \t ", " \t").empty());
  CHECK(trim("", " ").empty());
  CHECK(trim("\na ", " ") == "\na");
}
