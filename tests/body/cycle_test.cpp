#include "pliant/body/cycle.hpp"

#include <cmath>
#include <vector>

#include "body/sheets.hpp"
#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

namespace {

constexpr int frames = 6;

// A sheet that is pressed to and fro.
struct Pressed {
  NodeSheet sheet = hilly_sheet(9, 8);
  GridBody body{sheet.grid, sheet.rest, {.measure = Measure::Rest}};

  Result<void> advance(int frame) {
    return body.step(inputs_of({press(0, 0, 300 * std::sin(6.283185307 * frame / frames))}));
  }
  CycleRound round() {
    return {.frames = frames, .frame_time = 1.0 / 24, .advance = [this](int frame) {
              return advance(frame);
            }};
  }
};

double longest_row(const Field& a) { return a.rowwise().norm().maxCoeff(); }

}  // namespace

TEST_CASE("a cycle leads back to where it begins", "[body][cycle]") {
  Pressed pressed;
  std::vector<double> gaps;
  CycleRound round = pressed.round();
  round.told = [&](int number, double gap) {
    CHECK(number == static_cast<int>(gaps.size()) + 1);
    gaps.push_back(gap);
  };
  const BodyState begin = find_cycle(pressed.body, round).value();
  REQUIRE_FALSE(gaps.empty());
  CHECK(gaps.front() > 1e-3);  // it does not begin at rest
  pressed.body.restore(begin);
  double peak = peak_of(pressed.body);
  for (int frame = 0; frame < frames; ++frame) {
    REQUIRE(pressed.advance(frame));
    peak = std::max(peak, peak_of(pressed.body));
  }
  const BodyState& end = pressed.body.state();
  CHECK(longest_row(end.positions - begin.positions) <= 1e-6 * peak);
  CHECK(longest_row(end.velocities - begin.velocities) / 24 <= 1e-6 * peak);
  // The same search has the same bits.
  CHECK(find_cycle(pressed.body, pressed.round()).value() == begin);
}

TEST_CASE("what rests is a cycle at once", "[body][cycle]") {
  Pressed pressed;
  int rounds = 0;
  const BodyState begin =
      find_cycle(pressed.body, {.frames = 3,
                                .advance = [&](int) { return pressed.body.step(inputs_of({})); },
                                .told = [&](int, double) { ++rounds; }})
          .value();
  CHECK(begin == pressed.body.rest_state());
  CHECK(rounds == 1);
}

TEST_CASE("an error ends the search, but not one of a state that no motion leads on from",
          "[body][cycle]") {
  const auto found_with = [](ErrorCode code, int bad) {
    Pressed pressed;
    CycleRound round = pressed.round();
    int calls = 0;
    round.advance = [&](int frame) -> Result<void> {
      if (++calls == bad) return fail(code, "bad");
      return pressed.advance(frame);
    };
    return find_cycle(pressed.body, round);
  };
  for (const int bad : {1, 2 * frames + 2}) {
    const auto stopped = found_with(ErrorCode::Interrupted, bad);
    REQUIRE_FALSE(stopped);
    CHECK(stopped.error().code == ErrorCode::Interrupted);
  }
  // From rest nothing else can be tried; a combination gives way to what the motion led to.
  CHECK_FALSE(found_with(ErrorCode::NotFinite, 1));
  CHECK(found_with(ErrorCode::NotFinite, 2 * frames + 2));
}

TEST_CASE("a search for a cycle keeps within the memory that it may have", "[body][cycle]") {
  Pressed pressed;
  MemoryBudget memory(1000);
  CycleRound round = pressed.round();
  round.memory = &memory;
  const auto refused = find_cycle(pressed.body, round);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::OutOfMemory);
  CHECK_THAT(refused.error().message, Contains("looking for its cycle"));
  CHECK(memory.available() == memory.total());
}

TEST_CASE("a motion that does not close is told with its gap", "[body][cycle]") {
  Pressed pressed;
  // It goes somewhere else in each frame.
  const auto refused = find_cycle(pressed.body, {.frames = 2, .advance = [&](int) -> Result<void> {
                                                   BodyState state = pressed.body.state();
                                                   state.positions =
                                                       pressed.body.rest() +
                                                       Field::Random(state.positions.rows(), 3);
                                                   pressed.body.restore(state);
                                                   return {};
                                                 }});
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::SolverFailed);
  CHECK_THAT(refused.error().message,
             Contains("cycle of 2 frames") && Contains("1000 rounds") && Contains("damping"));
}
