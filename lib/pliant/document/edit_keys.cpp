// Operations on keys.

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "pliant/core/text.hpp"
#include "pliant/document/edit_curves.hpp"
#include "pliant/scene/text/text.hpp"
#include "pliant/timeline/curve_numbers.hpp"
#include "pliant/timeline/edit/edit.hpp"

namespace pliant::edit {
namespace {

/// A key's attributes that say the segment behind it.
constexpr std::string_view segment_attributes[] = {"interpolation", "amplitude", "period", "back",
                                                   "control"};

/// A curve some of whose keys are scaled, in their old order; new frames are multiples of `step`.
/// Errors: an amplitude that would need another factor for each component.
template <int D>
Checked<CurveKeys<D>> scaled_some(const CurveKeys<D>& before, const std::vector<std::size_t>& keys,
                                  const Scaling<D>& scaling, double step) {
  const auto is_even = std::ranges::all_of(scaling.value_factor, [&](double factor) {
    return std::fabs(factor) == std::fabs(scaling.value_factor[0]);
  });
  const auto stepped = [&](double frame) {
    if (step == 0 || scaling.time_factor == 1) return frame;
    // Multiples of 0.1, for example, are short only as quotients.
    const double per_frame = std::round(1 / step);
    const double count = std::round(frame / step);
    return (step == 1 / per_frame ? count / per_frame : count * step) + 0.0;  // no -0
  };
  const CurveKeys<D> scaled = scaled_keys(before, scaling);
  const bool are_all = keys.size() == before.keys.size();
  CurveKeys<D> wanted = are_all ? scaled : before;
  for (const std::size_t k : keys) {
    Key<D>& key = wanted.keys[k] = scaled.keys[k];
    key.frame = stepped(key.frame);
    const Interpolation& next = before.keys[k].next;
    if (!are_all && !std::ranges::binary_search(keys, k + 1))
      key.next = next;
    else if (!is_even && next.kind == Interpolation::Kind::Easing && next.ease == Ease::Elastic &&
             next.amplitude)
      return tl::unexpected(
          Complaint{k, fmt::format("the elastic segment behind frame {} has one amplitude for all "
                                   "components; their value factors must be of the same size",
                                   before.keys[k].frame)});
  }
  if (!wanted.loop) return wanted;
  // The loop goes with keys where it begins and ends.
  const auto end_at = [&](double frame, double scaled_frame) {
    const auto key = std::ranges::lower_bound(before.keys, frame, {}, &Key<D>::frame);
    if (key != before.keys.end() && key->frame == frame)
      return wanted.keys[key - before.keys.begin()].frame;
    return are_all ? stepped(scaled_frame) : frame;
  };
  wanted.loop->from = end_at(before.loop->from, scaled.loop->from);
  wanted.loop->to = end_at(before.loop->to, scaled.loop->to);
  return wanted;
}

/// Rounds the numbers in the unit of the channel that differ from those before.
template <int D>
void round_changed(CurveKeys<D> before, CurveKeys<D>& wanted, int digits) {
  std::vector<double> old;
  for_each_number(before, [&](double& number) { old.push_back(number); });
  auto was = old.begin();
  for_each_number(wanted, [&](double& number) {
    if (number != *was++) number = with_digits(number, digits);
  });
}

}  // namespace

Result<void> Editor::operator()(const SetKey& set) {
  const auto spot = this->spot(set.channel);
  if (!spot) return fail(spot.error());
  if (!animated(*spot)) {
    std::string value = set.value.value_or("");
    const auto present = constant(*spot);
    if (!set.value || on_path(*spot)) {
      if (!present) return fail(present.error());
      value = *present;
    }
    return insert_animate(*spot, set.frame, value);
  }
  const auto curve = curve_of(*spot);
  if (!curve) return fail(curve.error());
  return std::visit([&](const auto& one) { return set_key(one, set); }, *curve);
}

template <int D>
Result<void> Editor::set_key(const KeyedCurve<D>& curve, const SetKey& set) {
  const auto& keys = curve.keys();
  const auto next = std::ranges::lower_bound(keys, set.frame, {}, &Key<D>::frame);
  const std::size_t index = next - keys.begin();
  if (next != keys.end() && next->frame == set.frame) {
    if (!set.value) return {};
    draft_.set(curve.elements[index], "value", *set.value);
    parts_.insert(curve.channel);
    return {};
  }
  if (!std::isfinite(set.frame))
    return draft_.refuse(
        fmt::format("{}: a key's frame must be finite, not {}", set.channel, set.frame));
  // With the value of the curve, the curve stays.
  const auto parsed = xml::parse_value<D>(set.value.value_or(""), curve.kind);
  if (!set.value || (parsed && *parsed == curve.curve.value(set.frame))) {
    const auto inserted = insert_key(curve.curve, set.frame);
    if (!inserted && !set.value)
      return draft_.refuse(fmt::format("{}: {}", set.channel, inserted.error().message));
    if (inserted) return write_curve(curve, inserted->keys());
  }
  xml::ElementText key{
      .name = "key",
      .attributes = {{std::string(xml::place_name(curve.axis)), to_text(set.frame)},
                     {"value", *set.value}}};
  Draft::Place place{.parent = curve.animate};
  if (index > 0) {
    place.after = curve.elements[index - 1];
    for (const std::string_view name : segment_attributes)
      if (auto value = draft_.value(*place.after, name))
        key.attributes.emplace_back(name, *std::move(value));
  }
  draft_.insert(key, place);
  parts_.insert(curve.channel);
  return {};
}

Result<void> Editor::operator()(const DeleteKeys& deletion) {
  return for_each_keys(
      deletion.keys, [&]<int D>(const KeyedCurve<D>& curve, const std::vector<std::size_t>& keys) {
        const auto fewer = delete_keys(curve.curve, keys);
        if (!fewer)
          return Result<void>(
              draft_.refuse(fmt::format("{}: {}", curve.channel, fewer.error().message)));
        return write_curve(curve, fewer->keys());
      });
}

/// A number of each component, of those that an operation has for all or each of them.
template <int D>
Result<Value<D>> Editor::of_components(const KeyedCurve<D>& curve, std::string_view name,
                                       const std::vector<double>& numbers, double absent) const {
  if (numbers.size() > 1 && numbers.size() != D)
    return draft_.refuse(
        fmt::format("{}: the {} has {} numbers; one for all components or {} are possible",
                    curve.channel, name, numbers.size(), D));
  Value<D> value;
  for (std::size_t c = 0; c < D; ++c)
    value[c] = numbers.empty() ? absent : numbers[numbers.size() == 1 ? 0 : c];
  return value;
}

/// Writes the keys of `wanted`, which are those of the curve in their old order; `moved` may have
/// come to the frames of others.
template <int D>
Result<void> Editor::write_moved(const KeyedCurve<D>& curve, const CurveKeys<D>& wanted,
                                 const std::vector<std::size_t>& moved, Collision collision) {
  const auto frame_of = [](const KeyEntry<D>& entry) { return entry.key.frame; };
  std::vector<KeyEntry<D>> entries, others;
  for (std::size_t k = 0; k < wanted.keys.size(); ++k)
    (std::ranges::binary_search(moved, k) ? entries : others).push_back({wanted.keys[k], k});
  std::set<double> taken;
  for (const KeyEntry<D>& entry : entries) {
    const double frame = entry.key.frame;
    if (!std::isfinite(frame))
      return draft_.refuse(
          fmt::format("{}: the key of frame {} would come to frame {}, which is not finite",
                      curve.channel, curve.keys()[*entry.origin].frame, frame));
    const bool is_first = taken.insert(frame).second;
    const bool is_free = !std::ranges::binary_search(others, frame, {}, frame_of);
    if (is_first && (is_free || collision == Collision::Replace)) continue;
    return draft_.refuse(
        fmt::format("{}: the key of frame {} would come to frame {}, where there is one",
                    curve.channel, curve.keys()[*entry.origin].frame, frame));
  }
  std::erase_if(others, [&](const auto& one) { return taken.contains(one.key.frame); });
  entries.insert(entries.end(), others.begin(), others.end());
  std::ranges::stable_sort(entries, {}, frame_of);
  return write_curve(curve, wanted, entries);
}

Result<void> Editor::operator()(const MoveKeys& move) {
  return for_each_keys(
      move.keys,
      [&]<int D>(const KeyedCurve<D>& curve, const std::vector<std::size_t>& keys) -> Result<void> {
        const auto rises = of_components(curve, "rise", move.rise, 0);
        if (!rises) return fail(rises.error());
        CurveKeys<D> wanted = curve.curve.keys();
        for (const std::size_t k : keys) {
          Key<D>& key = wanted.keys[k];
          key.frame += move.frames;
          if (wanted.loop && curve.curve.keys().loop->from == curve.keys()[k].frame)
            wanted.loop->from = key.frame;
          for (std::size_t c = 0; c < D; ++c) {
            const double rise = (*rises)[c];
            if (rise == 0) continue;
            key.value[c] = with_digits(key.value[c] + rise, move.digits);
            if (key.left) (*key.left)[c] = with_digits((*key.left)[c] + rise, move.digits);
          }
        }
        return write_moved(curve, wanted, keys, move.collision);
      });
}

Result<void> Editor::operator()(const ScaleKeys& scale) {
  const auto must = [&](std::string_view what, std::string_view rule, double number) {
    return draft_.refuse(fmt::format("the {} must be {}, not {}", what, rule, number));
  };
  if (!std::isfinite(scale.frame)) return must("frame", "finite", scale.frame);
  if (!std::isfinite(scale.time_factor) || scale.time_factor <= 0)
    return must("time factor", "finite and above 0", scale.time_factor);
  if (!std::isfinite(scale.step) || scale.step < 0)
    return must("step", "finite and not below 0", scale.step);
  return for_each_keys(
      scale.keys,
      [&]<int D>(const KeyedCurve<D>& curve, const std::vector<std::size_t>& keys) -> Result<void> {
        const auto value = of_components(curve, "value", scale.value, 0);
        if (!value) return fail(value.error());
        const auto factor = of_components(curve, "value factor", scale.value_factor, 1);
        if (!factor) return fail(factor.error());
        const Scaling<D> scaling{.frame = scale.frame,
                                 .time_factor = scale.time_factor,
                                 .value = *value,
                                 .value_factor = *factor};
        if (curve.kind == xml::ValueKind::Boolean && (*factor)[0] != 1)
          return draft_.refuse(
              fmt::format("{}: a boolean channel has no multiples", curve.channel));
        auto wanted = scaled_some(curve.curve.keys(), keys, scaling, scale.step);
        if (!wanted)
          return draft_.refuse(fmt::format("{}: {}", curve.channel, wanted.error().message));
        round_changed(curve.curve.keys(), *wanted, scale.digits);
        return write_moved(curve, *wanted, keys, scale.collision);
      });
}

void Editor::set_side(ElementIndex key, Side side, std::string_view name,
                      const std::string& value) {
  // What both sides share becomes that of the other side.
  if (side != Side::Both) {
    if (const auto shared = draft_.value(key, "tangent")) {
      draft_.remove_attribute(key, "tangent");
      draft_.set(key, side == Side::In ? "out" : "in", *shared);
    }
  }
  for (const Side one : {Side::In, Side::Out}) {
    if (side != Side::Both && side != one) continue;
    const std::string own = one == Side::In ? "in" : "out";
    if (own != name) draft_.remove_attribute(key, own);
    if (own + "Handle" != name) draft_.remove_attribute(key, own + "Handle");
    if (own + "Handle" == name) draft_.remove_attribute(key, own + "Length");
  }
  draft_.set(key, name, value);
}

Result<void> Editor::operator()(const SetTangent& set) {
  return for_each_keys(
      set.keys,
      [&]<int D>(const KeyedCurve<D>& curve, const std::vector<std::size_t>& keys) -> Result<void> {
        for (const std::size_t k : keys) {
          const ElementIndex key = curve.elements[k];
          if (set.tangent)
            set_side(key, set.side,
                     set.side == Side::Both ? "tangent"
                     : set.side == Side::In ? "in"
                                            : "out",
                     *set.tangent);
          if (!set.length) continue;
          if (set.side != Side::Out) draft_.set(key, "inLength", *set.length);
          if (set.side != Side::In) draft_.set(key, "outLength", *set.length);
        }
        parts_.insert(curve.channel);
        return draft_.commit();
      });
}

Result<void> Editor::operator()(const SetHandle& set) {
  if (set.side == Side::Both)
    return draft_.refuse(fmt::format("{}: a handle is that of one side of a key", set.channel));
  return for_each_keys(
      {{set.channel, {set.frame}}},
      [&]<int D>(const KeyedCurve<D>& curve, const std::vector<std::size_t>& keys) {
        set_side(curve.elements[keys.front()], set.side,
                 set.side == Side::In ? "inHandle" : "outHandle", set.handle);
        parts_.insert(curve.channel);
        return draft_.commit();
      });
}

Result<void> Editor::operator()(const SetInterpolation& set) {
  const std::string word(xml::trimmed(set.interpolation));
  const auto is_read = [&](std::string_view name) {
    if (name == "control") return word == "cubicBezier";
    if (name == "back") return word.starts_with("back");
    return word.starts_with("elastic");
  };
  return for_each_keys(
      set.keys, [&]<int D>(const KeyedCurve<D>& curve, const std::vector<std::size_t>& keys) {
        for (const std::size_t k : keys) {
          const ElementIndex key = curve.elements[k];
          draft_.set(key, "interpolation", set.interpolation);
          for (const auto& [name, value] :
               {std::pair{"amplitude", set.amplitude}, std::pair{"period", set.period},
                std::pair{"back", set.back}, std::pair{"control", set.control}}) {
            if (value)
              draft_.set(key, name, *value);
            else if (!is_read(name))
              draft_.remove_attribute(key, name);
          }
        }
        parts_.insert(curve.channel);
        return draft_.commit();
      });
}

Result<void> Editor::operator()(const SetExtrapolation& set) {
  for (const std::string& channel : set.channels) {
    const auto curve = curve_of(channel);
    if (!curve) return fail(curve.error());
    const ElementIndex animate = std::visit([](const auto& one) { return one.animate; }, *curve);
    if (set.before) draft_.set(animate, "before", *set.before);
    if (set.after) draft_.set(animate, "after", *set.after);
    parts_.insert(channel);
    if (auto done = draft_.commit(); !done) return done;
  }
  return {};
}

}  // namespace pliant::edit
