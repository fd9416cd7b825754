#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>

namespace pliant {

/// Names of the prims below one, each once. Not for other rooms.
class UsdaNames {
 public:
  /// The name itself where USD allows it: letters, digits and `_`, no digit first. Everything else
  /// becomes `_`, and `_2`, `_3`, … is put behind a name that is taken.
  std::string take(std::string_view name);

 private:
  std::set<std::string> taken_;
  std::map<std::string, int> next_suffix_;  // of the names that were asked for, to try next
};

/// The text in quotes, as a string of USD.
std::string usda_string(std::string_view text);

}  // namespace pliant
