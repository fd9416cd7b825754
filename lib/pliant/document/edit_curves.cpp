// Operations that make a curve anew.

#include "pliant/document/edit_curves.hpp"

#include "pliant/timeline/edit/bake_keys.hpp"
#include "pliant/timeline/edit/simplify.hpp"

namespace pliant::edit {

Result<AnyCurve> Editor::curve_of(const Spot& spot) const {
  const auto animate = animated(spot);
  if (animate) return read_keyed_curve(draft_, *animate, spot.format.type, spot.path);
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

}  // namespace pliant::edit
