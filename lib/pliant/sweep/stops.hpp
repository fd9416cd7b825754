#pragma once

#include <cstddef>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant {

// How the loops of a sweep end when asked. Internal to sweep.

inline tl::unexpected<Error> interrupted() { return fail(ErrorCode::Interrupted, "interrupted"); }

inline bool is_stopped(const StopRequest& should_stop) { return should_stop && should_stop(); }

/// The same for a loop over takes, values or files, which asks now and then.
inline bool is_stopped(const StopRequest& should_stop, std::size_t count) {
  constexpr std::size_t between_stops = 256;
  return count % between_stops == 0 && is_stopped(should_stop);
}

}  // namespace pliant
