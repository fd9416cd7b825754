#pragma once

#include <set>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "support/catch.hpp"
#include "support/sanitized.hpp"

namespace pliant::testing {

/// How often work(should_stop) asks if it is never stopped; it must succeed.
template <class Work>
int asks_of(const Work& work) {
  int asks = 0;
  const auto done = work(StopRequest([&] {
    ++asks;
    return false;
  }));
  CAPTURE(done ? "" : done.error().message);
  CHECK(done);
  return asks;
}

/// A request that is told once, or at every ask from then on.
enum class Stop { Once, Always };

/// Checks that the work asks at least so often, and that it is over soon after a stop at any of
/// several moments. Then `look` is called. Under sanitizers only the stops are made, which are
/// short.
template <class Work, class Look>
void check_stops(const Work& work, int least_asks, const Look& look, Stop stop = Stop::Once) {
  std::set moments = {1, least_asks / 2, least_asks};
  if (!is_sanitized) {
    const int asks = asks_of(work);
    CHECK(asks >= least_asks);
    moments = {1, 2, asks / 3, asks / 2, asks - 1, asks};
  }
  for (const int moment : moments) {
    if (moment < 1) continue;
    int asked = 0;
    const auto done = work(StopRequest([&] {
      ++asked;
      return asked == moment || (stop == Stop::Always && asked > moment);
    }));
    CAPTURE(moment, asked);
    REQUIRE_FALSE(done);
    CHECK(done.error().code == ErrorCode::Interrupted);
    CHECK(asked <= moment + (stop == Stop::Always ? 8 : 2));
    look();
  }
}

template <class Work>
void check_stops(const Work& work, int least_asks) {
  check_stops(work, least_asks, [] {});
}

}  // namespace pliant::testing
