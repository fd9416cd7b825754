#pragma once

#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant::cli {

inline constexpr int exit_done = 0;
inline constexpr int exit_failed = 1;  ///< the run failed
inline constexpr int exit_usage = 2;   ///< wrong usage, or a scene that cannot be read

/// Writes lines to a standard stream; control characters for terminals are written as `\xHH`. Line
/// breaks are kept, so pass names with arbitrary bytes, such as file names, through `printable`
/// first.
///
/// A closed or full stream does not end the work; output lost on stdout makes the exit code 1
/// (`exit_code_after_output`).
void print(std::FILE* stream, std::string_view text);

/// Writes bytes to the standard output or error as they are; to a terminal as `print` does.
void print_bytes(std::FILE* stream, std::string_view bytes);

/// "1 frame", "2 frames"; with `many`, "1 vertex", "2 vertices".
std::string counted(std::int64_t count, std::string_view one, std::string_view many = {});

/// The exit code for an error.
int exit_code(const Error& error);

/// The exit code of a command that ends with `code`: 1, with a line on stderr, if some output could
/// not be written to stdout.
int exit_code_after_output(int code);

/// Prints every problem on stderr, one line each, and returns the exit code.
int report(const Error& error);

/// Prints notes on a scene: remarks on valid content.
void print_notes(std::span<const SceneNote> notes);

/// Prints a warning about a place of a scene on stderr.
void print_warning(const ScenePlace& place, const std::string& message);

/// Prints warnings about a scene, each with its line.
void print_warnings(std::span<const Warning> warnings, const SceneOrigin& origin);

/// Prints the warnings of a run, each with its line.
void print_warnings(const Simulation& simulation);

}  // namespace pliant::cli
