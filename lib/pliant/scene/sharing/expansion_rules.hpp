#pragma once

#include <algorithm>
#include <optional>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/scene/format/description.hpp"
#include "pliant/scene/sharing/expand.hpp"

namespace pliant::xml {

inline constexpr std::string_view fragment_name = "fragment";
inline constexpr std::string_view scene_name = Description<Scene>::element;

/// What the format says about the places and values that are expanded.
class ExpansionRules {
 public:
  ExpansionRules();

  bool may_contain(std::string_view element) const {
    return std::find(containers_.begin(), containers_.end(), element) != containers_.end();
  }
  const std::vector<std::string_view>& containers() const { return containers_; }

  /// The elements that a file that is included may consist of.
  const std::vector<std::string_view>& roots() const { return roots_; }

  /// Whether the value is a text, which is not computed.
  bool is_text(std::string_view element, std::string_view attribute) const {
    return texts_.contains({element, attribute});
  }

 private:
  std::vector<std::string_view> containers_;
  std::vector<std::string_view> roots_ = {fragment_name, scene_name};
  std::set<std::pair<std::string_view, std::string_view>> texts_;
};

/// The first text in a range that is not in comments, up to the next element; null: none.
std::optional<TextRange> bare_text(std::string_view text, TextRange content);

}  // namespace pliant::xml
