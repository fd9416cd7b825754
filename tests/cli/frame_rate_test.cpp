#include "cli/commands/frame_rate.hpp"

#include <limits>

#include "support/catch.hpp"

using Catch::Matchers::WithinAbs;
using pliant::cli::frame_rate;
using pliant::cli::FrameRate;
using pliant::cli::to_text;

TEST_CASE("a frame rate is the fraction that its author wrote", "[cli][movie]") {
  CHECK(frame_rate(24) == FrameRate{24, 1});
  CHECK(frame_rate(12.5) == FrameRate{25, 2});
  CHECK(frame_rate(0.1) == FrameRate{1, 10});
  CHECK(frame_rate(1.0 / 3) == FrameRate{1, 3});
  for (const int frames : {24000, 30000, 48000, 60000, 120000}) {
    CAPTURE(frames);
    CHECK(frame_rate(frames / 1001.0) == FrameRate{frames, 1001});
  }
  CHECK(frame_rate(23.976) == FrameRate{2997, 125});
}

TEST_CASE("a quotient that a fraction gives is that fraction's", "[cli][movie]") {
  const int seconds = 997;
  for (int frames = 10; frames <= 2000; ++frames) {  // fewer are below the least rate
    CAPTURE(frames);
    const auto rate = frame_rate(static_cast<double>(frames) / seconds);
    REQUIRE(rate);
    CHECK(static_cast<double>(rate->frames) / rate->seconds ==
          static_cast<double>(frames) / seconds);
  }
}

TEST_CASE("what is no such fraction is within a millionth of one", "[cli][movie]") {
  for (const double fps : {3.14159265358979, 23.976023976, 29.97002997, 0.0123456789, 999.99999}) {
    CAPTURE(fps);
    const auto rate = frame_rate(fps);
    REQUIRE(rate);
    CHECK_THAT(static_cast<double>(rate->frames) / rate->seconds, WithinAbs(fps, 1e-6 * fps));
  }
}

TEST_CASE("no fraction stands for what no movie can show", "[cli][movie]") {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const double fps :
       {1e-7, 1e7, -24.0, 0.0, infinity, std::numeric_limits<double>::quiet_NaN(), 1e-310, 1e300}) {
    CAPTURE(fps);
    CHECK_FALSE(frame_rate(fps));
  }
}

TEST_CASE("a whole rate is told as one number", "[cli][movie]") {
  CHECK(to_text({24, 1}) == "24");
  CHECK(to_text({24000, 1001}) == "24000/1001");
}
