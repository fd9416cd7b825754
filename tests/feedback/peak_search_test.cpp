#include "pliant/feedback/peak_search.hpp"

#include <algorithm>
#include <cmath>

#include "support/catch.hpp"

using namespace pliant;
using Catch::Matchers::WithinRel;

namespace {

struct Search {
  FactorFound found;
  int plays = 0;
};

template <class Peak>
Search search(double wanted, const Peak& peak, int most = 12) {
  Search one;
  const auto peak_at = [&](double factor) -> Result<double> {
    ++one.plays;
    return peak(factor);
  };
  one.found = find_factor(wanted, most, peak_at).value();
  return one;
}

}  // namespace

TEST_CASE("a proportional peak is found in two plays", "[feedback][suggest]") {
  for (const double wanted : {1e-6, 0.3, 7.0, 1e5}) {
    const Search one = search(
        wanted, [](double factor) { return 2.5 * factor; }, 20);
    CHECK_THAT(one.found.peak, WithinRel(wanted, 1e-3));
    CHECK_THAT(one.found.factor, WithinRel(wanted / 2.5, 1e-3));
    CHECK(one.plays <= (wanted == 0.3 || wanted == 7 ? 2 : 5));  // at most a hundredfold in a play
  }
}

TEST_CASE("a peak that is there is kept", "[feedback][suggest]") {
  const Search one = search(1, [](double factor) { return 1.0005 * factor; });
  CHECK(one.plays == 1);
  CHECK(one.found.factor == 1);
}

TEST_CASE("peaks that bend are found too", "[feedback][suggest]") {
  const auto yields = [](double f) { return f < 0.8 ? f : f + 3 * (f - 0.8) * (f - 0.8); };
  const auto tangents = [](double f) { return std::hypot(0.5 + 0.2 * f, 0.7 * f); };
  const auto saturates = [](double f) { return 4 * f / (1 + 0.3 * f); };
  for (const double wanted : {0.6, 1.5, 5.0}) {
    for (const std::function<double(double)>& peak :
         {std::function<double(double)>(yields), std::function<double(double)>(tangents),
          std::function<double(double)>(saturates)}) {
      const Search one = search(wanted, peak);
      CHECK(one.found.obstacle == Obstacle::None);
      CHECK_THAT(peak(one.found.factor), WithinRel(wanted, 1e-3));
    }
  }
}

TEST_CASE("a peak that cannot be is told from one that was not found", "[feedback][suggest]") {
  CHECK(search(1, [](double) { return 0; }).found.obstacle == Obstacle::NothingMoves);
  const Search far = search(5, [](double f) { return std::min(2 * f, 3.0); });
  CHECK(far.found.obstacle == Obstacle::LeavesReach);
  CHECK_THAT(far.found.peak, WithinRel(3, 1e-9));
  const Search anyway = search(0.1, [](double f) { return std::max(0.5, f); });
  CHECK(anyway.found.obstacle == Obstacle::MovesAnyway);
  CHECK_THAT(anyway.found.peak, WithinRel(0.5, 1e-9));
  for (const int plays : {12, 24}) {
    const Search jump = search(
        2.5, [](double f) { return f < 1.7 ? f : 2 * f; }, plays);
    CHECK(jump.found.obstacle == Obstacle::LeavesReach);
    CHECK_THAT(jump.found.peak, WithinRel(1.7, 0.02));
    CHECK_THAT(jump.found.other_peak, WithinRel(3.4, 0.02));
  }
  CHECK(search(
            2.5, [](double f) { return f < 1.7 ? f : 2 * f; }, 4)
            .found.obstacle == Obstacle::NotFound);
}

TEST_CASE("an error of a play ends the search", "[feedback][suggest]") {
  const auto found = find_factor(
      1, 12, [](double) -> Result<double> { return fail(ErrorCode::NotFinite, "far away"); });
  REQUIRE_FALSE(found);
  CHECK(found.error().message == "far away");
}
