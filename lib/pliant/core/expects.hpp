#pragma once

/// Stops the program when a caller breaks a documented "Requires:". Never for user data: a scene or
/// a mesh that breaks a rule is an `Error`. Checked in Debug and wherever PLIANT_CHECKS is set,
/// which every preset does.
#if defined(PLIANT_CHECKS) || !defined(NDEBUG)
#define PLIANT_EXPECTS(condition) \
  ((condition) ? void(0) : ::pliant::contract_broken(#condition, __FILE__, __LINE__))
#else
#define PLIANT_EXPECTS(condition) void(0)
#endif

namespace pliant {

/// Says on stderr which requirement was broken, and terminates.
[[noreturn]] void contract_broken(const char* condition, const char* file, int line);

}  // namespace pliant
