#include "pliant/core/field.hpp"

#include <cmath>
#include <limits>

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("the longest vector is found at every scale", "[core][field]") {
  Field field = Field::Zero(4, 3);
  CHECK(longest_vector(field).length == 0);
  field.row(1) << 3, 0, -4;
  field.row(2) << 0, 4, 3;
  field.row(3) << 1, -1, 1;
  for (const double scale : {1.0, 1e-9, 1e140, 1e160, 1e300, 3e307, 1e-160, 1e-300}) {
    CAPTURE(scale);
    const Field scaled = scale * field;
    const LongestVector longest = longest_vector(scaled);
    CHECK(longest.row == 1);
    CHECK(std::abs(longest.length / (5 * scale) - 1) < 1e-15);
  }
  field(2, 0) = std::numeric_limits<double>::infinity();
  CHECK(std::isinf(longest_vector(field).length));
}
