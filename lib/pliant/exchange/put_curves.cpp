#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pliant/exchange/curve_names.hpp"
#include "pliant/exchange/scene_curves.hpp"
#include "pliant/scene/channel_check.hpp"
#include "pliant/scene/curve_text.hpp"
#include "pliant/scene/description.hpp"
#include "pliant/scene/element_text.hpp"
#include "pliant/scene/markup.hpp"
#include "pliant/scene/read.hpp"

namespace pliant {
namespace {

xml::ElementText element_of(const PlacedCurve& curve, const std::string& attribute) {
  if (const auto* number = std::get_if<CurveKeys<1>>(&curve.keys)) {
    return xml::curve_element(attribute, *number,
                              curve.is_switch ? xml::ValueKind::Boolean : xml::ValueKind::Number);
  }
  return xml::curve_element(attribute, std::get<CurveKeys<3>>(curve.keys), xml::ValueKind::Vector);
}

/// The element of a surface that has an attribute; empty: none.
std::string_view part_of_surface(std::string_view attribute) {
  std::string_view part;
  const auto look = [&]<class Part>(const Part& standard) {
    describe(
        [&](const Attribute& row, const auto&...) {
          if (row.name == attribute) part = Description<Part>::element;
        },
        standard);
  };
  look(TransformChannels{});
  look(MaterialChannels{});
  look(TangentChannels{});
  look(SolverSettings{});
  return part;
}

/// The text of a scene file in which one curve replaces what a channel has.
class CurveEdit {
 public:
  CurveEdit(std::string text, const std::string& name)
      : text_(std::move(text)),
        name_(name),
        line_end_(text_.find("\r\n") == std::string::npos ? "\n" : "\r\n") {}

  Result<std::string> put(const PlacedCurve& curve) {
    xml::Findings findings(name_);
    auto markup = xml::scan_markup(text_, findings);
    if (!markup) return fail(findings.to_error());
    markup_ = *std::move(markup);
    const auto [thing, attribute] = exchange::split_channel(curve.channel);
    const auto element = find_thing(thing);
    if (!element)
      return invalid(fmt::format("{}: the file has no element named {}", curve.channel, thing));
    return put_into(*element, attribute, curve);
  }

 private:
  using Element = std::size_t;

  std::string_view name_of(Element element) const {
    return markup_.elements[element].name.of(text_);
  }

  const xml::AttributePlace* attribute_of(Element element, std::string_view name) const {
    for (const xml::AttributePlace& each : markup_.attributes_of(element))
      if (each.name.of(text_) == name) return &each;
    return nullptr;
  }

  bool has_value(Element element, std::string_view name, std::string_view value) const {
    const xml::AttributePlace* const place = attribute_of(element, name);
    return place && xml::decoded(place->value.of(text_)) == value;
  }

  /// Names are unique among surfaces, forces and groups.
  std::optional<Element> find_thing(std::string_view name) const {
    for (Element k = 1; k < markup_.elements.size(); ++k) {
      const std::uint32_t parent = markup_.elements[k].parent;
      const bool is_thing = parent == 0 || name_of(parent) == "group";
      if (is_thing && has_value(k, "name", name)) return k;
    }
    return {};
  }

  template <class Is>
  std::optional<Element> find_child(Element parent, const Is& is_it) const {
    for (Element k = parent + 1; k < markup_.elements.size(); ++k)
      if (markup_.elements[k].parent == parent && is_it(k)) return k;
    return {};
  }

  std::optional<Element> find_child(Element parent, std::string_view name) const {
    return find_child(parent, [&](Element k) { return name_of(k) == name; });
  }

  Result<std::string> put_into(Element thing, const std::string& attribute,
                               const PlacedCurve& curve) {
    const std::size_t dot = attribute.find('.');
    if (dot != std::string::npos) {  // `center.progress` of a path
      const std::string position = attribute.substr(0, dot);
      const auto path = find_child(thing, [&](Element k) {
        return name_of(k) == "path" && has_value(k, "attribute", position);
      });
      if (!path)
        return invalid(fmt::format("{}: the file has no <path> for {}", curve.channel, position));
      return replaced(*path, element_of(curve, attribute.substr(dot + 1)),
                      attribute.substr(dot + 1));
    }
    const auto path = find_child(thing, [&](Element k) {
      return name_of(k) == "path" && has_value(k, "attribute", attribute);
    });
    if (path) return invalid(fmt::format("{}: follows a <path>; remove that first", curve.channel));
    const xml::ElementText animate = element_of(curve, attribute);
    if (name_of(thing) != "surface") return replaced(thing, animate, attribute);
    const std::string_view part = part_of_surface(attribute);
    if (part.empty())
      return invalid(fmt::format("{}: a surface has no such channel", curve.channel));
    if (const auto found = find_child(thing, part)) return replaced(*found, animate, attribute);
    xml::ElementText whole{std::string(part)};
    whole.children.push_back(animate);
    return inserted(thing, whole);
  }

  std::string replaced(Element parent, const xml::ElementText& animate,
                       const std::string& attribute) const {
    const auto old = find_child(parent, [&](Element k) {
      return name_of(k) == "animate" && has_value(k, "attribute", attribute);
    });
    if (old) {
      const xml::TextRange range = markup_.elements[*old].whole();
      return text_.substr(0, range.begin) +
             xml::text_of(animate, layout_in(parent), margin_of(*old)) + text_.substr(range.end);
    }
    std::string result = inserted(parent, animate);
    // What it had as a constant stands before.
    if (const xml::AttributePlace* const constant = attribute_of(parent, attribute)) {
      const std::uint32_t end = constant->whole().end;
      std::uint32_t begin = constant->name.begin;
      while (is_blank(text_[begin - 1])) --begin;
      result.erase(begin, end - begin);
    }
    return result;
  }

  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

  std::string inserted(Element parent, const xml::ElementText& element) const {
    const xml::ElementPlace& place = markup_.elements[parent];
    const std::string outer = margin_of(parent);
    const xml::Layout layout = layout_in(parent);
    const std::string margin = outer + layout.indent;
    const std::string text = line_end_ + margin + xml::text_of(element, layout, margin);
    const std::string closing = line_end_ + outer + fmt::format("</{}>", name_of(parent));
    if (place.closes_itself()) {
      std::size_t slash = text_.rfind('/', place.end);
      while (is_blank(text_[slash - 1])) --slash;
      return text_.substr(0, slash) + '>' + text + closing + text_.substr(place.end);
    }
    std::size_t end = text_.rfind("</", place.end - 1);
    while (is_blank(text_[end - 1])) --end;
    return text_.substr(0, end) + text + closing + text_.substr(place.end);
  }

  /// The blanks before an element, if nothing else stands before it on its line.
  std::string margin_of(Element element) const {
    const std::size_t begin = markup_.elements[element].whole().begin;
    std::size_t line = begin;
    while (line > 0 && (text_[line - 1] == ' ' || text_[line - 1] == '\t')) --line;
    const bool is_first = line == 0 || text_[line - 1] == '\n';
    return is_first ? text_.substr(line, begin - line) : "";
  }

  xml::Layout layout_in(Element parent) const {
    xml::Layout layout;
    layout.line_end = line_end_;
    const std::string outer = margin_of(parent);
    const auto child = find_child(parent, [](Element) { return true; });
    const std::string inner = child ? margin_of(*child) : "";
    if (inner.size() > outer.size() && inner.starts_with(outer))
      layout.indent = inner.substr(outer.size());
    return layout;
  }

  std::string text_;
  const std::string& name_;
  std::string line_end_;
  xml::Markup markup_;
};

}  // namespace

Result<std::string> with_curves(std::string_view text, const std::string& name,
                                const std::string& folder, const std::string& root,
                                const PlacedCurves& curves) {
  std::string result(text);
  if (auto scene = parse_scene(result, name, folder, root); !scene) return fail(scene.error());
  for (const PlacedCurve& curve : curves.curves) {
    auto changed = CurveEdit(std::move(result), name).put(curve);
    if (!changed) return fail(changed.error());
    result = *std::move(changed);
  }
  const auto broken = [](Error error) {
    error.message = "with the curves the scene would be wrong: " + error.message;
    return fail(std::move(error));
  };
  auto scene = parse_scene(result, name, folder, root);
  if (!scene) return broken(scene.error());
  if (auto errors = check_channels(*scene); !errors.empty())
    return broken(as_one(std::move(errors), name));
  return result;
}

std::string animate_elements(const PlacedCurves& curves) {
  std::string text;
  std::string last;
  for (const PlacedCurve& curve : curves.curves) {
    const auto [thing, attribute] = exchange::split_channel(curve.channel);
    if (thing != last) text += fmt::format("<!-- {} -->\n", thing);
    last = thing;
    text += xml::text_of(element_of(curve, attribute)) + '\n';
  }
  return text;
}

}  // namespace pliant
