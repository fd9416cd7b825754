#pragma once

#include <string>

// The only file that depends on the version of Catch2: Debian 12 has version 2, others 3.
#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
#else
#include <catch2/catch.hpp>
#endif

namespace pliant::testing {

using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

/// Matches a text that contains `part`.
inline auto contains_text(const std::string& part) {
#if __has_include(<catch2/catch_all.hpp>)
  return Catch::Matchers::ContainsSubstring(part);
#else
  return Catch::Matchers::Contains(part);
#endif
}

}  // namespace pliant::testing
