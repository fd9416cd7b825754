#include "pliant/document/keyed_curve.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <tinyxml2.h>

#include "pliant/scene/element.hpp"
#include "pliant/scene/findings.hpp"
#include "pliant/scene/read_elements.hpp"
#include "pliant/scene/text.hpp"

namespace pliant::edit {
namespace {

template <int D>
Result<AnyCurve> read_curve_of(const Draft& draft, Element animate, xml::ValueKind kind,
                               const std::string& channel) {
  tinyxml2::XMLDocument document;
  const std::string_view text = draft.whole(animate);
  const int first_line = draft.line_of(animate);
  xml::Findings findings(draft.file());
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    return draft.refuse(fmt::format("{}: {}", channel, document.ErrorName()));
  const tinyxml2::XMLElement& element = *document.RootElement();
  const auto axis = draft.name(animate) == "falloff" ? xml::KeyAxis::Falloff : xml::KeyAxis::Frame;
  auto curve = xml::read_curve<D>(element, axis, kind, channel, findings);
  if (!curve) {
    Error error = findings.to_error();
    error.line += first_line - 1;
    for (Error& other : error.others) other.line += first_line - 1;
    return fail(std::move(error));
  }
  KeyedCurve<D> result{.channel = channel,
                       .animate = animate,
                       .elements = draft.children(animate, "key"),
                       .axis = axis,
                       .kind = kind,
                       .defaults = {},
                       .curve = *std::move(curve)};
  if (kind == xml::ValueKind::Boolean)
    result.defaults.interpolation.kind = Interpolation::Kind::Step;
  xml::Table table = xml::table_of(result.defaults, axis, kind);
  xml::Findings again(draft.file());
  xml::read_attributes(element, table, again);
  return AnyCurve(std::move(result));
}

/// Whether a key has three numbers as its value; see the reader of a tangent's channel.
bool has_wide_values(const Draft& draft, Element animate) {
  const std::vector<Element> keys = draft.children(animate, "key");
  return std::ranges::any_of(keys, [&](Element key) {
    return xml::words_of(draft.value(key, "value").value_or("")).size() > 1;
  });
}

}  // namespace

Result<AnyCurve> read_keyed_curve(const Draft& draft, Element animate, std::string_view type,
                                  const std::string& channel) {
  using xml::ValueKind;
  if (type == "vector") return read_curve_of<3>(draft, animate, ValueKind::Vector, channel);
  if (type == "boolean") return read_curve_of<1>(draft, animate, ValueKind::Boolean, channel);
  if (type == "number or vector" && has_wide_values(draft, animate))
    return read_curve_of<3>(draft, animate, ValueKind::Widened, channel);
  return read_curve_of<1>(draft, animate, ValueKind::Number, channel);
}

}  // namespace pliant::edit
