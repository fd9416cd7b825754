#include "pliant/timeline/number_text.hpp"

#include <cstdlib>
#include <limits>

#include "support/catch.hpp"

namespace pliant::testing {
namespace {

TEST_CASE("numbers are written as short as they can be read back", "[timeline][number_text]") {
  CHECK(timeline::number_text(0.1) == "0.1");
  CHECK(timeline::number_text(12) == "12");
  CHECK(timeline::number_text(-std::numeric_limits<double>::infinity()) == "-inf");
  for (const double number : {1.0 / 3, 1e300, -5e-324, std::numeric_limits<double>::max()}) {
    CHECK(std::strtod(timeline::number_text(number).c_str(), nullptr) == number);
  }
}

}  // namespace
}  // namespace pliant::testing
