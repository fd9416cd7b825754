#include "pliant/document/keyed_curve.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "pliant/scene/channels.hpp"
#include "pliant/scene/elements/element.hpp"
#include "pliant/scene/elements/read_elements.hpp"
#include "pliant/scene/text/findings.hpp"
#include "pliant/scene/text/text.hpp"
#include "pliant/scene/text/tree.hpp"

namespace pliant::edit {
namespace {

/// The curve of a channel with the defaults of its <animate>, which `element` is.
template <int D>
AnyCurve keyed(const Draft& draft, const xml::Element& element, KeyedCurve<D> result) {
  result.elements = draft.children(result.animate, "key");
  if (result.kind == xml::ValueKind::Boolean)
    result.defaults.interpolation.kind = Interpolation::Kind::Step;
  xml::Table table = xml::table_of(result.defaults, result.axis, result.kind);
  xml::Findings findings(draft.file(), SourceText::of(draft.text()), draft.should_stop());
  xml::read_attributes(element, table, findings);
  return result;
}

template <int D>
Result<AnyCurve> read_curve_of(const Draft& draft, ElementIndex animate, xml::ValueKind kind,
                               const std::string& channel) {
  const xml::Tree tree = draft.tree();
  const xml::Element element(tree, 0, animate);
  xml::Findings findings(draft.file(), SourceText::of(draft.text()), draft.should_stop());
  const auto axis = draft.name(animate) == "falloff" ? xml::KeyAxis::Falloff : xml::KeyAxis::Frame;
  auto curve = xml::read_curve<D>(element, axis, kind, channel, findings);
  if (!curve) return fail(findings.to_error());
  return keyed<D>(draft, element,
                  {.channel = channel,
                   .animate = animate,
                   .elements = {},
                   .axis = axis,
                   .kind = kind,
                   .defaults = {},
                   .curve = *std::move(curve)});
}

/// The curve of a channel that has keys with `$`.
Result<AnyCurve> read_computed_curve(const Draft& draft, ElementIndex animate,
                                     const std::string& channel, const ParseScene& parse) {
  const xml::Tree tree = draft.tree();
  const auto scene = parse(draft.text());
  if (!scene) return fail(scene.error());
  const std::vector<NamedChannel> channels = channels_of(*scene);
  const auto found = std::ranges::find(channels, channel, &NamedChannel::path);
  if (is_computed(draft, animate) || found == channels.end() || !found->is_animated())
    return draft.refuse(
        fmt::format("{}: its <{}> has a value with $, which is not edited; change the text, or set "
                    "a number first",
                    channel, draft.name(animate)));
  const auto with = [&]<int D>(xml::ValueKind kind, const Curve<D>& curve) {
    return keyed<D>(draft, xml::Element(tree, 0, animate),
                    {.channel = channel,
                     .animate = animate,
                     .elements = {},
                     .axis = xml::KeyAxis::Frame,
                     .kind = kind,
                     .defaults = {},
                     .curve = curve});
  };
  using xml::ValueKind;
  return std::visit(
      [&]<class One>(const One* one) {
        if constexpr (std::is_same_v<One, Switch>)
          return with(ValueKind::Boolean, one->channel().curve());
        else
          return with(std::is_same_v<One, Channel<1>> ? ValueKind::Number : ValueKind::Vector,
                      one->curve());
      },
      found->channel);
}

/// Whether a key has three numbers as its value; see the reader of a tangent's channel.
bool has_wide_values(const Draft& draft, ElementIndex animate) {
  const std::vector<ElementIndex> keys = draft.children(animate, "key");
  return std::ranges::any_of(keys, [&](ElementIndex key) {
    return xml::words_of(draft.value(key, "value").value_or("")).size() > 1;
  });
}

}  // namespace

bool is_computed(const Draft& draft, ElementIndex element) {
  return std::ranges::any_of(draft.attributes(element), [&](const xml::AttributePlace& one) {
    return xml::decoded(one.value.of(draft.text())).find('$') != std::string::npos;
  });
}

Result<AnyCurve> read_keyed_curve(const Draft& draft, ElementIndex animate, std::string_view type,
                                  const std::string& channel, const ParseScene& parse) {
  using xml::ValueKind;
  const std::vector<ElementIndex> keys = draft.children(animate);
  if (is_computed(draft, animate) ||
      std::ranges::any_of(keys, [&](ElementIndex key) { return is_computed(draft, key); }))
    return read_computed_curve(draft, animate, channel, parse);
  if (type == "vector") return read_curve_of<3>(draft, animate, ValueKind::Vector, channel);
  if (type == "boolean") return read_curve_of<1>(draft, animate, ValueKind::Boolean, channel);
  if (type == "number or vector" && has_wide_values(draft, animate))
    return read_curve_of<3>(draft, animate, ValueKind::Widened, channel);
  return read_curve_of<1>(draft, animate, ValueKind::Number, channel);
}

}  // namespace pliant::edit
