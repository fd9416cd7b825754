#include "cli/commands/look.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "pliant/core/text.hpp"
#include "pliant/scene/format/nearest.hpp"

namespace pliant::cli {
namespace {

enum class Kind { Number, Positive, Word, Switch, Names };

struct LookWord {
  std::string_view name;
  Kind kind = Kind::Number;
  std::vector<std::string_view> allowed = {};
};

// As readLook of viewer/page/src/look.ts.
const std::vector<LookWord>& look_words() {
  static const std::vector<std::string_view> on_or_off = {"on", "off"};
  static const std::vector<std::string_view> axes = {"x", "y", "z"};
  static const std::vector<LookWord> words = {
      {"frame"},
      {"turn"},
      {"tilt"},
      {"up", Kind::Word, axes},
      {"style", Kind::Word, {"shaded", "lines", "wireframe"}},
      {"colour", Kind::Word, {"plain", "displacement", "signed", "velocity"}},
      {"theme", Kind::Word, {"light", "dark"}},
      {"gizmos", Kind::Word, on_or_off},
      {"labels", Kind::Word, on_or_off},
      {"regions", Kind::Word, on_or_off},
      {"boxes", Kind::Word, on_or_off},
      {"colliders", Kind::Word, on_or_off},
      {"floor", Kind::Word, on_or_off},
      {"legend", Kind::Word, on_or_off},
      {"caption", Kind::Word, on_or_off},
      {"clean", Kind::Switch, on_or_off},
      {"hide", Kind::Names},
      {"solo", Kind::Names},
      {"peak", Kind::Positive},
  };
  return words;
}

// What is wrong with a value; empty: nothing.
std::string complaint_of(const LookWord& word, std::string_view value) {
  switch (word.kind) {
    case Kind::Number:
      return to_number(value) ? "" : "must be a number";
    case Kind::Positive:
      return to_number(value).value_or(0) > 0 ? "" : "must be a number above 0";
    case Kind::Switch:
      if (value.empty()) return "";  // the word alone is on
      [[fallthrough]];
    case Kind::Word:
      if (std::find(word.allowed.begin(), word.allowed.end(), value) != word.allowed.end())
        return "";
      return "unknown value" + xml::hint(value, word.allowed);
    case Kind::Names:
      break;
  }
  return "";
}

Result<void> check_pair(std::string_view pair) {
  const std::size_t equals = std::min(pair.find('='), pair.size());
  const std::string_view name = pair.substr(0, equals);
  const auto refuse = [&](const std::string& complaint) {
    return fail(ErrorCode::InvalidInput, fmt::format("--look {}: {}", printable(pair), complaint));
  };
  const auto& words = look_words();
  const auto word = std::find_if(words.begin(), words.end(),
                                 [&](const LookWord& each) { return each.name == name; });
  if (word == words.end()) {
    std::vector<std::string_view> names;
    for (const LookWord& each : words) names.push_back(each.name);
    return refuse("unknown word" + xml::hint(name, names));
  }
  const std::string_view value = pair.substr(std::min(equals + 1, pair.size()));
  const std::string complaint = complaint_of(*word, value);
  return complaint.empty() ? Result<void>() : refuse(complaint);
}

}  // namespace

Result<void> check_look(const std::string& look) {
  std::string_view rest = look;
  if (!rest.empty() && rest.front() == '#') rest.remove_prefix(1);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('&'), rest.size());
    if (end > 0) {
      if (auto pair = check_pair(rest.substr(0, end)); !pair) return pair;
    }
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return {};
}

}  // namespace pliant::cli
