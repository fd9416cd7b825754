#pragma once

#include <span>
#include <string_view>

namespace pliant::cli {

/// A scene to begin with: a file of cli/new/starters.
struct Starter {
  std::string_view name;
  std::string_view scene;         ///< the text of the file
  std::string_view mesh = {};     ///< the text of the OBJ file that its <mesh> names; empty: none
  std::string_view picture = {};  ///< a PNG of it
};

/// All starters, the simplest first.
std::span<const Starter> starters();

/// What it shows, in one line: the first sentence of its first comment.
std::string_view summary_of(const Starter& starter);

}  // namespace pliant::cli
