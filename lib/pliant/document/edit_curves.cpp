// Operations that make a curve anew.

#include "pliant/document/edit_curves.hpp"

#include <cmath>

#include "pliant/core/text.hpp"
#include "pliant/scene/elements/curve_text.hpp"
#include "pliant/scene/text/text.hpp"
#include "pliant/timeline/curve_numbers.hpp"
#include "pliant/timeline/edit/bake_keys.hpp"
#include "pliant/timeline/edit/edit.hpp"
#include "pliant/timeline/edit/simplify.hpp"

namespace pliant::edit {
namespace {

/// Rounds what a curve has in the unit of its channel.
template <int D>
CurveKeys<D> rounded_keys(CurveKeys<D> curve, int digits) {
  for_each_number(curve, [digits](double& number) { number = with_digits(number, digits); });
  return curve;
}

}  // namespace

Result<AnyCurve> Editor::curve_of(const Spot& spot) const {
  const auto animate = animated(spot);
  if (animate) return read_keyed_curve(draft_, *animate, spot.format.type, spot.path, parse_);
  if (on_path(spot))
    return draft_.refuse(
        fmt::format("{0} follows a path; its keys are those of {0}.progress", spot.path));
  return draft_.refuse(fmt::format("{} has no keys", spot.path));
}

Result<AnyCurve> Editor::curve_of(const std::string& channel) const {
  const auto spot = this->spot(channel);
  if (!spot) return fail(spot.error());
  if (spot->component)
    return draft_.refuse(
        fmt::format("{} is a component; the keys of {} share it", channel, spot->path));
  return curve_of(*spot);
}

Result<void> Editor::operator()(const BakeKeys& bake) {
  return for_each_curve(bake.channels, [&]<int D>(const KeyedCurve<D>& curve) -> Result<void> {
    if (curve.kind == xml::ValueKind::Boolean)
      return draft_.refuse(
          fmt::format("{}: a boolean channel steps and is not baked", curve.channel));
    const auto baked =
        bake_keys(curve.curve, bake.first, bake.last, bake.step,
                  bake.is_linear ? Interpolation::Kind::Linear : Interpolation::Kind::Bezier);
    if (!baked) return draft_.refuse(fmt::format("{}: {}", curve.channel, baked.error().message));
    return write_curve(curve, *baked);
  });
}

Result<void> Editor::operator()(const SimplifyKeys& simplification) {
  return for_each_curve(
      simplification.channels, [&]<int D>(const KeyedCurve<D>& curve) -> Result<void> {
        if (curve.kind == xml::ValueKind::Boolean)
          return draft_.refuse(
              fmt::format("{}: a boolean channel steps and is not simplified", curve.channel));
        const auto fewer = simplify(
            curve.curve, simplification.first.value_or(curve.keys().front().frame),
            simplification.last.value_or(curve.keys().back().frame), simplification.tolerance);
        if (!fewer)
          return draft_.refuse(fmt::format("{}: {}", curve.channel, fewer.error().message));
        return write_curve(curve, fewer->keys);
      });
}

Result<void> Editor::operator()(const Scale& scale) {
  if (!std::isfinite(scale.factor))
    return draft_.refuse(fmt::format("the factor must be finite, not {}", scale.factor));
  for (const std::string& channel : scale.channels) {
    const auto spot = this->spot(channel);
    if (!spot) return fail(spot.error());
    if (!animated(*spot)) {
      if (auto done = scale_constant(*spot, scale); !done) return done;
      continue;
    }
    auto done = for_each_curve({channel}, [&]<int D>(const KeyedCurve<D>& curve) -> Result<void> {
      if (curve.kind == xml::ValueKind::Boolean)
        return draft_.refuse(fmt::format("{}: a boolean channel has no multiples", channel));
      const auto multiple =
          pliant::scale(curve.curve, Scaling<D>{.value_factor = Scaling<D>::filled(scale.factor)});
      if (!multiple)
        return draft_.refuse(
            fmt::format("{}: times {}: {}", channel, scale.factor, multiple.error().message));
      return write_curve(curve, rounded_keys(multiple->keys(), scale.digits));
    });
    if (!done) return done;
  }
  return {};
}

/// Multiplies the numbers of a constant channel, a component of it perhaps.
Result<void> Editor::scale_constant(const Spot& spot, const Scale& scale) {
  auto value = constant(spot);
  if (!value) return fail(value.error());
  std::vector<std::string_view> words = xml::words_of(*value);
  if (spot.component && words.size() > *spot.component) words = {words[*spot.component]};
  std::vector<double> numbers;
  for (const std::string_view word : words) {
    const auto number = xml::parse_number(word);
    if (!number || !spot.format.is_keyable)
      return draft_.refuse(
          fmt::format("{} is {}, of which there are no multiples", spot.path, in_quotes(*value)));
    numbers.push_back(with_digits(scale.factor * *number, scale.digits));
  }
  std::string result = changed_words(*value, to_text(numbers));
  if (spot.component) {
    auto whole = with_component(spot, to_text(numbers));
    if (!whole) return fail(whole.error());
    result = *std::move(whole);
  }
  if (result == *value) return {};
  return set_constant(spot, result);
}

/// The curve of keys that a channel may have.
template <int D>
Result<Curve<D>> Editor::curve_for(const Spot& spot, const CurveKeys<D>& keys) const {
  const std::string& type = spot.format.type;
  if (!spot.format.is_keyable || spot.component)
    return draft_.refuse(fmt::format("{} cannot be animated", spot.path));
  if (type != "number or vector" && (type == "vector") != (D == 3))
    return draft_.refuse(fmt::format("{} has {}, so its keys cannot have {}", spot.path,
                                     D == 3 ? "single numbers" : "vectors of three numbers",
                                     D == 3 ? "vectors" : "single numbers"));
  auto curve = Curve<D>::make(keys, draft_.should_stop());
  if (curve) return *std::move(curve);
  if (curve.error().kind == Complaint::Kind::Interrupted) return interrupted();
  return draft_.refuse(fmt::format("{}: {}", spot.path, curve.error().message));
}

template <int D>
Result<void> Editor::set_curve(const Spot& spot, const CurveKeys<D>& keys) {
  using xml::ValueKind;
  if (const auto curve = curve_for(spot, keys); !curve) return fail(curve.error());
  if (on_path(spot)) return curve_of(spot).map([](const auto&) {});
  if (const auto old = animated(spot)) {
    const auto present = curve_of(spot);
    const auto* const same = present ? std::get_if<KeyedCurve<D>>(&*present) : nullptr;
    if (same) {
      replaces_computed_ = true;
      auto done = write_curve(*same, keys);
      replaces_computed_ = false;
      return done;
    }
    // What the text has cannot become these keys, such as numbers vectors.
    draft_.remove(*old);
    if (auto done = draft_.commit(); !done) return done;
    return set_curve(*this->spot(spot.path), keys);
  }
  const ValueKind kind = D == 3                          ? ValueKind::Vector
                         : spot.format.type == "boolean" ? ValueKind::Boolean
                                                         : ValueKind::Number;
  return insert_animate(spot,
                        xml::curve_element(spot.attribute(), keys, kind, draft_.should_stop()));
}

Result<void> Editor::operator()(const SetCurve& set) {
  const auto spot = this->spot(set.channel);
  if (!spot) return fail(spot.error());
  return std::visit([&](const auto& keys) { return set_curve(*spot, keys); }, set.keys);
}

template <int D>
Result<void> Editor::splice(const Spot& spot, const Splice& splice, const CurveKeys<D>& keys) {
  const auto piece = curve_for(spot, keys);
  if (!piece) return fail(piece.error());
  const auto refuse = [&](const Complaint& complaint) {
    return draft_.refuse(fmt::format("{}: {}", spot.path, complaint.message));
  };
  if (!animated(spot)) {
    const auto alone = pliant::splice(*piece, splice.first, splice.last, *piece);
    return alone ? set_curve(spot, alone->keys()) : refuse(alone.error());
  }
  const auto present = curve_of(spot);
  if (!present) return fail(present.error());
  const auto* const curve = std::get_if<KeyedCurve<D>>(&*present);
  if (!curve)
    return draft_.refuse(fmt::format("{}: its keys have {}, those of the piece {}", spot.path,
                                     D == 3 ? "single numbers" : "vectors",
                                     D == 3 ? "vectors" : "single numbers"));
  const auto result = pliant::splice(curve->curve, splice.first, splice.last, *piece);
  if (!result) return refuse(result.error());
  std::vector<KeyEntry<D>> entries = entries_of(*curve, result->keys());
  // A new value takes the place of a computed one.
  for (KeyEntry<D>& entry : entries) {
    const bool is_new = entry.key.frame >= splice.first && entry.key.frame <= splice.last;
    if (is_new && entry.origin && is_computed(draft_, curve->elements[*entry.origin]))
      entry.origin.reset();
  }
  return write_curve(*curve, result->keys(), entries);
}

Result<void> Editor::operator()(const Splice& splice) {
  const auto spot = this->spot(splice.channel);
  if (!spot) return fail(spot.error());
  return std::visit([&](const auto& keys) { return this->splice(*spot, splice, keys); },
                    splice.keys);
}

}  // namespace pliant::edit
