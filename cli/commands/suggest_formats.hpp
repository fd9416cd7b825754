#pragma once

#include <string>

#include "pliant/pliant.hpp"

namespace pliant::cli {

/// A suggestion, and what it is for.
struct SuggestFacts {
  std::string file;     ///< the name given by the caller
  std::string surface;  ///< its name
  std::string force;    ///< the name of the force or group that acts alone; empty: all
  double fps = 24;
  Suggestion suggestion;
  bool is_written = false;
};

/// The output of `pliant suggest --json`: docs/info.md.
std::string suggest_json(const SuggestFacts& facts);

/// The text that `pliant suggest` prints.
std::string suggest_text(const SuggestFacts& facts);

}  // namespace pliant::cli
