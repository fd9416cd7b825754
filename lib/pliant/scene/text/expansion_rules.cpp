#include "pliant/scene/text/expansion_rules.hpp"

#include <iterator>
#include <string>

#include "pliant/scene/elements/read_elements.hpp"
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

std::string_view bare_text(std::string_view content) {
  while (!content.empty()) {
    const std::string_view before = trimmed(content.substr(0, content.find('<')));
    if (!before.empty() || content.find('<') == std::string_view::npos) return before;
    content.remove_prefix(content.find('<'));
    if (!content.starts_with("<!--")) return content;
    content.remove_prefix(content.find("-->", 4) + 3);
  }
  return {};
}

std::vector<std::string_view> including_elements() {
  std::vector<std::string_view> names;
  for (const ElementFormat& each : scene_format())
    if (each.may_include) names.push_back(each.name);
  return names;
}

bool needs_expansion(const SourceText& source, Findings& findings) {
  // A $ may also be written as &#36;.
  for (const std::string_view sign : {"$", "&#"})
    if (find_from(source.text, sign, 0, findings) != std::string_view::npos) return true;
  return std::any_of(source.markup.elements.begin(), source.markup.elements.end(),
                     [&](const ElementPlace& element) {
                       const std::string_view name = element.name.of(source.text);
                       return name == include_name || name == define_name;
                     });
}

}  // namespace pliant::xml
