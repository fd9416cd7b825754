#pragma once

#include <string>

#include "pliant/core/result.hpp"

namespace pliant::cli {

/// Checks the words of `--look`, those of the page's address in docs/viewer.md: the page ignores
/// one that is wrong. Errors: InvalidInput, naming the option, the word and what is allowed.
Result<void> check_look(const std::string& look);

}  // namespace pliant::cli
