#include "pliant/body/state_numbers.hpp"

#include <vector>

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("a state is its numbers, with velocities as lengths", "[body][cycle]") {
  BodyState state{.positions = Field::Random(3, 3), .velocities = Field::Random(3, 3)};
  state.unsettled = {1, 0, 1};
  const std::vector<double> numbers = numbers_of(state, 0.25);
  REQUIRE(numbers.size() == 18);
  CHECK(number_count(state) == 18);
  CHECK(numbers[9] == 0.25 * state.velocities.data()[0]);
  BodyState other{.positions = Field::Zero(3, 3), .velocities = Field::Zero(3, 3)};
  other.unsettled = state.unsettled;
  CHECK(with_numbers(other, 0.25, numbers) == state);
}
