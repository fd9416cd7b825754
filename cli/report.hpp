#pragma once

#include <cstdio>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant::cli {

inline constexpr int exit_done = 0;
inline constexpr int exit_failed = 1;  ///< the run failed
inline constexpr int exit_usage = 2;   ///< wrong usage, or a scene that cannot be read

/// Writes to a standard stream. A stream that is closed or full is no reason to fail: what could
/// not be said is not worth more than the work.
void print(std::FILE* stream, std::string_view text);

/// Prints every problem on stderr, one line each, and gives the exit code.
int report(const Error& error);

/// Prints what reading a scene found that is legal, but that its author would want to know.
void print_notes(const Scene& scene);

}  // namespace pliant::cli
