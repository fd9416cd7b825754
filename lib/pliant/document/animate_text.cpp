#include "pliant/document/animate_text.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "pliant/scene/elements/curve_text.hpp"
#include "pliant/scene/elements/read_elements.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/scene/text/findings.hpp"
#include "pliant/scene/text/markup.hpp"
#include "pliant/scene/text/text.hpp"
#include "pliant/scene/text/tree.hpp"
#include "pliant/timeline/curve.hpp"

namespace pliant::edit {
namespace {

constexpr std::string_view element_name = Description<xml::AnimateText<1>>::element;

/// What the values of the keys are.
xml::ValueKind kind_of(const xml::Element& animate) {
  for (auto key = animate.first_child(); key; key = key->next()) {
    const auto value = key->attribute("value");
    if (!value) continue;
    if (xml::words_of(value->value).size() > 1) return xml::ValueKind::Widened;
    const std::string_view word = xml::trimmed(value->value);
    if (word == "true" || word == "false") return xml::ValueKind::Boolean;
  }
  return xml::ValueKind::Number;
}

template <int D>
std::optional<AnyKeys> keys_of(const xml::Element& animate, xml::ValueKind kind,
                               const std::string& channel, xml::Findings& findings) {
  const auto curve = xml::read_curve<D>(animate, xml::KeyAxis::Frame, kind, channel, findings);
  if (!curve) return std::nullopt;
  return curve->keys();
}

}  // namespace

Checked<std::string> animate_text(const AnyKeys& keys, const std::string& channel) {
  std::string attribute = channel.substr(channel.rfind('.') + 1);
  if (!is_name(attribute)) attribute = "channel";
  const xml::Layout one_line{
      .line_end = "", .indent = "", .columns = std::numeric_limits<std::size_t>::max()};
  return std::visit(
      [&]<int D>(const CurveKeys<D>& of) -> Checked<std::string> {
        if (const auto curve = Curve<D>::make(of); !curve) return tl::unexpected(curve.error());
        const auto kind = D == 3 ? xml::ValueKind::Vector : xml::ValueKind::Number;
        return xml::text_of(xml::curve_element(attribute, of, kind), one_line);
      },
      keys);
}

Result<AnyKeys> keys_of_animate(const std::string& text, const std::string& channel,
                                std::int64_t& copies, const StopRequest& should_stop) {
  if (text.size() > largest_scene_file)
    return invalid(fmt::format("it is larger than {} MiB", largest_scene_file >> 20U));
  xml::Findings findings("", SourceText::of(text), should_stop);
  findings.count_copied_keys(copies);
  const std::vector<std::string_view> roots{element_name};
  const auto markup = xml::scan_markup(findings, 0, xml::most_markup, roots);
  if (findings.is_stopped()) return interrupted();
  if (!markup) return fail(findings.to_error());
  const xml::Tree tree(text, *markup);
  const xml::Element animate = tree.root();
  const xml::ValueKind kind = kind_of(animate);
  auto keys = kind == xml::ValueKind::Widened ? keys_of<3>(animate, kind, channel, findings)
                                              : keys_of<1>(animate, kind, channel, findings);
  if (findings.is_stopped()) return interrupted();
  if (!keys) return fail(findings.to_error());
  copies = findings.copied_keys();
  return *std::move(keys);
}

}  // namespace pliant::edit
