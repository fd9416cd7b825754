#pragma once

#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>

#include "pliant/scene/changes/change.hpp"

namespace pliant {

/// The values that some changes are of, to find two of one value among many. Internal to the
/// library.
class ChangedValues {
 public:
  /// Adds the next change, and returns the number of the first one before it that is of the same
  /// value, or of a part of it (`SceneChange::overlaps`), counted from 0; null: there is none.
  std::optional<std::size_t> add(const SceneChange& change);

 private:
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

  // The first changes of an attribute. Parts of a <path> are those of another value than others.
  struct Firsts {
    std::size_t any[2] = {none, none};  // of others, and of a <path>
    std::size_t whole = none, whole_set = none;
    std::map<std::string, std::size_t> parts = {};
  };

  std::size_t count_ = 0;
  std::unordered_map<std::string, Firsts> attributes_;  // by what a path begins with
};

}  // namespace pliant
