#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "pliant/document/document.hpp"
#include "pliant/exchange/curve_names.hpp"
#include "pliant/exchange/scene_curves.hpp"
#include "pliant/scene/elements/curve_text.hpp"
#include "pliant/scene/text/element_text.hpp"

namespace pliant {
namespace {

xml::ElementText element_of(const PlacedCurve& curve, const std::string& attribute,
                            const StopRequest& should_stop) {
  if (const auto* number = std::get_if<CurveKeys<1>>(&curve.keys)) {
    return xml::curve_element(attribute, *number,
                              curve.is_switch ? xml::ValueKind::Boolean : xml::ValueKind::Number,
                              should_stop);
  }
  return xml::curve_element(attribute, std::get<CurveKeys<3>>(curve.keys), xml::ValueKind::Vector,
                            should_stop);
}

}  // namespace

Result<std::string> with_curves(std::string_view text, const std::string& name,
                                const std::string& folder, const std::string& root,
                                const PlacedCurves& curves, const StopRequest& should_stop) {
  auto document = SceneDocument::from_text(std::string(text), name, folder,
                                           {.root = root, .should_stop = should_stop});
  if (!document) return fail(document.error());
  std::vector<Operation> operations;
  for (const PlacedCurve& curve : curves.curves)
    operations.emplace_back(edit::SetCurve{curve.channel, curve.keys});
  if (auto changed = document->apply(operations, "import curves"); !changed) {
    Error error = changed.error();
    if (error.code == ErrorCode::Interrupted) return fail(std::move(error));
    error.message = "the scene cannot have the curves: " + error.message;
    error.line = 0;  // of a text that nobody sees
    return fail(std::move(error));
  }
  return document->text();
}

std::string animate_elements(const PlacedCurves& curves, const StopRequest& should_stop) {
  std::string text;
  std::string last;
  for (const PlacedCurve& curve : curves.curves) {
    if (is_stopped(should_stop)) break;
    const auto [thing, attribute] = exchange::split_channel(curve.channel);
    if (thing != last) text += fmt::format("<!-- {} -->\n", thing);
    last = thing;
    text += xml::text_of(element_of(curve, attribute, should_stop), {}, {}, should_stop) + '\n';
  }
  return text;
}

}  // namespace pliant
