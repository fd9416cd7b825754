#pragma once

#include <string_view>

/// Stops the program when a caller breaks a documented "Requires:". Never for user data: a scene or
/// a mesh that breaks a rule is an `Error`. Checked in Debug and wherever PLIANT_CHECKS is set,
/// which every preset does.
#if defined(PLIANT_CHECKS) || !defined(NDEBUG)
#define PLIANT_EXPECTS(condition) PLIANT_EXPECTS_OR(condition, #condition)
/// The same, but reports `message`, a std::string or a literal, instead of the condition. `message`
/// is evaluated only if the condition is false.
#define PLIANT_EXPECTS_OR(condition, message) \
  ((condition) ? void(0) : ::pliant::contract_broken(message, __FILE__, __LINE__))
#else
#define PLIANT_EXPECTS(condition) void(0)
#define PLIANT_EXPECTS_OR(condition, message) void(0)
#endif

namespace pliant {

/// Prints the broken requirement to stderr and terminates.
[[noreturn]] void contract_broken(std::string_view requirement, const char* file, int line);

}  // namespace pliant
