// Operations on keys.

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "pliant/document/edit_curves.hpp"
#include "pliant/scene/text/text.hpp"
#include "pliant/timeline/edit/edit.hpp"

namespace pliant::edit {
namespace {

/// A key's attributes that say the segment behind it.
constexpr std::string_view segment_attributes[] = {"interpolation", "amplitude", "period", "back",
                                                   "control"};

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

Result<void> Editor::operator()(const MoveKeys& move) {
  return for_each_keys(move.keys, [&]<int D>(const KeyedCurve<D>& curve,
                                             const std::vector<std::size_t>& keys) {
    const auto refuse = [&](std::string_view why) {
      return Result<void>(draft_.refuse(fmt::format("{}: {}", curve.channel, why)));
    };
    if (move.rise.size() > 1 && move.rise.size() != D)
      return refuse(
          fmt::format("the rise has {} numbers; one for all components or {} are possible",
                      move.rise.size(), D));
    const auto frame_of = [](const KeyEntry<D>& entry) { return entry.key.frame; };
    std::vector<KeyEntry<D>> moved, others;
    CurveKeys<D> wanted = curve.curve.keys();
    for (std::size_t k = 0; k < curve.keys().size(); ++k) {
      KeyEntry<D> entry{curve.keys()[k], k};
      if (!std::ranges::binary_search(keys, k)) {
        others.push_back(entry);
        continue;
      }
      const double frame = entry.key.frame;
      entry.key.frame += move.frames;
      if (wanted.loop && curve.curve.keys().loop->from == frame)
        wanted.loop->from = entry.key.frame;
      for (std::size_t c = 0; c < D && !move.rise.empty(); ++c) {
        const double rise = move.rise[move.rise.size() == 1 ? 0 : c];
        if (rise == 0) continue;
        entry.key.value[c] += rise;
        if (entry.key.left) (*entry.key.left)[c] += rise;
      }
      moved.push_back(entry);
    }
    std::set<double> taken;
    for (const KeyEntry<D>& entry : moved) {
      const double frame = entry.key.frame;
      const auto other = std::ranges::lower_bound(others, frame, {}, frame_of);
      if (other == others.end() || other->key.frame != frame) continue;
      if (move.collision == Collision::Refuse)
        return refuse(fmt::format("the key of frame {} would come to frame {}, where there is one",
                                  curve.keys()[*entry.origin].frame, frame));
      taken.insert(frame);
    }
    std::erase_if(others, [&](const auto& one) { return taken.contains(one.key.frame); });
    others.insert(others.end(), moved.begin(), moved.end());
    std::ranges::stable_sort(others, {}, frame_of);
    return write_curve(curve, wanted, others);
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
