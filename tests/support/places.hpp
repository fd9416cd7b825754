#pragma once

#include <filesystem>

namespace pliant::testing {

// Where things are on this machine: compiled into one small file, so that a compiler cache serves
// the others to every copy of the project.

std::filesystem::path source_folder();  ///< the project's

/// The program of mesh/boxed/misbehave.cpp.
std::filesystem::path misbehaving_program();

}  // namespace pliant::testing
