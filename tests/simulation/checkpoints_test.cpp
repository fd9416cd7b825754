#include "pliant/simulation/checkpoints.hpp"

#include "support/catch.hpp"

using namespace pliant;

namespace {

// 6 doubles a node.
std::vector<BodyState> states(double mark) {
  return {{Field::Constant(10, 3, mark), Field::Zero(10, 3)}};
}
constexpr std::size_t bytes = 10 * 6 * sizeof(double);

}  // namespace

TEST_CASE("within the budget every frame is kept", "[simulation][checkpoints]") {
  Checkpoints checkpoints(1, 10 * bytes);
  CHECK(checkpoints.latest_until(5) == nullptr);
  for (int frame = 2; frame <= 11; ++frame) checkpoints.offer(frame, states(frame));
  for (int frame = 2; frame <= 11; ++frame) {
    REQUIRE(checkpoints.latest_until(frame));
    CHECK(checkpoints.latest_until(frame)->first == frame);
    CHECK(checkpoints.latest_until(frame)->second == states(frame));
  }
  CHECK(checkpoints.latest_until(1) == nullptr);
}

TEST_CASE("beyond the budget frames thin out evenly", "[simulation][checkpoints]") {
  Checkpoints checkpoints(1, 8 * bytes);
  for (int frame = 1; frame <= 1000; ++frame) {
    if (checkpoints.is_due(frame)) checkpoints.offer(frame, states(frame));
  }
  // 8 kept states over 1000 frames: every 128 or 256.
  int kept = 0, last = 0;
  for (int frame = 1; frame <= 1000; ++frame) {
    const auto* checkpoint = checkpoints.latest_until(frame);
    REQUIRE(checkpoint);
    CHECK(checkpoint->second == states(checkpoint->first));
    CHECK(frame - checkpoint->first < 256);
    if (checkpoint->first != last) ++kept;
    last = checkpoint->first;
  }
  CHECK(kept >= 4);
  CHECK(kept <= 8);
}

TEST_CASE("no budget keeps nothing", "[simulation][checkpoints]") {
  Checkpoints none(1, 0), small(1, bytes - 1);
  CHECK_FALSE(none.is_due(1));
  none.offer(1, states(1));
  small.offer(1, states(1));
  CHECK(none.latest_until(9) == nullptr);
  CHECK(small.latest_until(9) == nullptr);
}
