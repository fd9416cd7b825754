#include "pliant/timeline/exact_sum.hpp"

#include "support/catch.hpp"
#include "support/sanitized.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

TEST_CASE("pairs hold sums and products exactly", "[timeline][exact_sum]") {
  Whim whim(91);
  for (int round = 0; round < rounds(2000); ++round) {
    // Integers with at most 62 bits in sum and product: an exact reference.
    const std::int64_t a = static_cast<std::int64_t>(whim.between(-0x1p31, 0x1p31));
    const std::int64_t b = static_cast<std::int64_t>(whim.between(-0x1p31, 0x1p31));
    const auto x = static_cast<double>(a);
    const auto y = static_cast<double>(b);
    const timeline::Pair product = timeline::exact_product(x, y);
    REQUIRE(static_cast<std::int64_t>(product.high) + static_cast<std::int64_t>(product.low) ==
            a * b);
    REQUIRE(product.high == x * y);
    const timeline::Pair sum = timeline::exact_sum(x * 0x1p40, y);
    REQUIRE(sum.high + sum.low == sum.high);
    REQUIRE((sum.high - x * 0x1p40) + sum.low == y);
  }
}

}  // namespace
}  // namespace pliant::testing
