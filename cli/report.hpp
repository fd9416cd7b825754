#pragma once

#include <cstdio>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant::cli {

inline constexpr int exit_done = 0;
inline constexpr int exit_failed = 1;  ///< the run failed
inline constexpr int exit_usage = 2;   ///< wrong usage, or a scene that cannot be read

/// Writes lines to a standard stream, what would act on a terminal as `\xHH`. A name that may hold
/// anything, such as a file's, goes through `printable` first: here a line break is one.
///
/// A stream that is closed or full does not end the work; what could not be written to stdout makes
/// the exit code 1 (`exit_code_after_output`).
void print(std::FILE* stream, std::string_view text);

/// The exit code that an error ends with.
int exit_code(const Error& error);

/// The exit code of a command that ends with `code`: 1, with a line on stderr, where something
/// could not be written to stdout.
int exit_code_after_output(int code);

/// Prints every problem on stderr, one line each, and gives the exit code.
int report(const Error& error);

/// Prints what reading a scene found that is legal, but that its author would want to know.
void print_notes(const Scene& scene);

/// Where a warning's cause stands: the force, or the tangents or start frame of its surface.
int line_of(const Warning& warning, const SceneOrigin& origin);

/// Prints what the author should know although the run went on, each with its line.
void print_warnings(const Simulation& simulation);

}  // namespace pliant::cli
