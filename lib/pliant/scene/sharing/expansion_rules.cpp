#include "pliant/scene/sharing/expansion_rules.hpp"

#include <iterator>
#include <string>

#include "pliant/scene/format/format.hpp"
#include "pliant/scene/text/text.hpp"

namespace pliant::xml {
namespace {

bool is_text_type(std::string_view type) {
  constexpr std::string_view types[] = {
      "path", "text", "name", "names", "word", "one or four words", "boolean"};
  return std::find(std::begin(types), std::end(types), type) != std::end(types);
}

}  // namespace

ExpansionRules::ExpansionRules() : containers_(including_elements()) {
  for (const ElementFormat& format : scene_format()) {
    const bool may_be_included =
        std::any_of(format.parents.begin(), format.parents.end(), [&](std::string_view parent) {
          return std::find(containers_.begin(), containers_.end(), parent) != containers_.end();
        });
    if (may_be_included && format.name != include_name && format.name != define_name)
      roots_.push_back(format.name);
    for (const AttributeFormat& attribute : format.attributes)
      if (is_text_type(attribute.type)) texts_.emplace(format.name, attribute.name);
  }
}

std::optional<TextRange> bare_text(std::string_view text, TextRange content) {
  std::string_view rest = content.of(text);
  const auto range_of = [&](std::string_view part) {
    const auto begin = static_cast<std::uint32_t>(part.data() - text.data());
    return TextRange{begin, begin + static_cast<std::uint32_t>(part.size())};
  };
  while (!rest.empty()) {
    const std::string_view before = trimmed(rest.substr(0, rest.find('<')));
    if (!before.empty()) return range_of(before);
    if (rest.find('<') == std::string_view::npos) break;
    rest.remove_prefix(rest.find('<'));
    if (!rest.starts_with("<!--")) return range_of(rest);
    rest.remove_prefix(rest.find("-->", 4) + 3);
  }
  return std::nullopt;
}

}  // namespace pliant::xml
