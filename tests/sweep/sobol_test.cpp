#include "pliant/sweep/sobol.hpp"

#include <algorithm>
#include <vector>

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("the first Sobol' points are those of the contract", "[sweep][sobol]") {
  const std::vector<double> wanted = {0.5,  0.5,  0.5,  0.75,  0.25,  0.25,
                                      0.25, 0.75, 0.75, 0.375, 0.375, 0.625};
  CHECK(sobol_points(3, 0, 4) == wanted);
}

TEST_CASE("more Sobol' points begin with the same", "[sweep][sobol]") {
  const std::size_t dimensions = GENERATE(1, 2, 7, 32);
  const std::vector<double> many = sobol_points(dimensions, 0, 200);
  const std::vector<double> few = sobol_points(dimensions, 0, 50);
  CHECK(std::equal(few.begin(), few.end(), many.begin()));
  const std::vector<double> later = sobol_points(dimensions, 50, 150);
  CHECK(std::equal(later.begin(), later.end(), many.begin() + 50 * static_cast<long>(dimensions)));
}

TEST_CASE("Sobol' points are a digital net in each coordinate", "[sweep][sobol]") {
  // With point 0, the first 2^m points have one in each interval of length 2^-m.
  constexpr std::size_t dimensions = 32, count = 256;
  const std::vector<double> points = sobol_points(dimensions, 0, count - 1);
  for (std::size_t d = 0; d < dimensions; ++d) {
    std::vector<int> hits(count);
    hits[0] = 1;
    for (std::size_t k = 0; k < count - 1; ++k)
      ++hits[static_cast<std::size_t>(points[k * dimensions + d] * count)];
    CHECK(std::all_of(hits.begin(), hits.end(), [](int n) { return n == 1; }));
  }
}
