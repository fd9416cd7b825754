#pragma once

#include <cstddef>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "support/catch.hpp"
#include "support/sanitized.hpp"

namespace pliant::testing {

/// Calls `work` with stop requests that are granted ever later, the first never: it must ask at
/// least `least_asked` times. Each of the others must end it, and none is asked again after it was
/// granted but by parts that end at once. Then `look` is called.
template <class Work, class Look>
void stop_at_every_moment(const Work& work, const Look& look, int least_asked) {
  int asked = 0;
  REQUIRE(work([&] { return ++asked < 0; }));
  CHECK(asked >= least_asked);
  const int all = asked;
  constexpr int few = 8;
  for (int moment = 1; moment <= all; moment += 1 + all / (is_sanitized ? 3 : 23)) {
    CAPTURE(moment, all);
    asked = 0;
    const auto ended = work([&] { return ++asked >= moment; });
    REQUIRE_FALSE(ended);
    CHECK(ended.error().code == ErrorCode::Interrupted);
    CHECK(asked <= moment + few);
    look();
  }
}

}  // namespace pliant::testing
