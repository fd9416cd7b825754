#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>

namespace pliant {

/// Unique names for the child prims of one prim. Internal to output.
class UsdaNames {
 public:
  /// The name itself if USD allows it: letters, digits and `_`, no digit first. All other
  /// characters become `_`, and `_2`, `_3`, … is appended to a name that is in use.
  std::string take(std::string_view name);

 private:
  std::set<std::string> taken_;
  std::map<std::string, int> next_suffix_;  // the suffix to try next, for each name requested
};

/// The text in quotes, as a USD string.
std::string usda_string(std::string_view text);

}  // namespace pliant
