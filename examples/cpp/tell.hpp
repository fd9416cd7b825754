#pragma once

#include <cstdio>
#include <string>

#include <pliant/pliant.hpp>

/// Prints an error, and all others found with it; returns the exit code for bad input.
inline int tell(const pliant::Error& error) {
  for (const std::string& line : pliant::to_lines(error))
    std::fprintf(stderr, "%s\n", line.c_str());
  return 2;
}
