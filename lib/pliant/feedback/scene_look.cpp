#include "pliant/feedback/scene_look.hpp"

#include <algorithm>
#include <variant>

#include <fmt/format.h>

#include "pliant/core/shortened.hpp"

namespace pliant {
namespace {

template <int D>
std::optional<KeySpan> span_of(const Channel<D>& channel) {
  if (!channel.is_animated()) return {};
  const CurveKeys<D>& curve = channel.curve().keys();
  using Beyond = typename Extrapolation<D>::Kind;
  return KeySpan{curve.keys.front().frame, curve.keys.back().frame, curve.keys.size(),
                 curve.before.kind == Beyond::Hold && !(curve.loop && curve.loop->before > 0),
                 curve.after.kind == Beyond::Hold && !(curve.loop && curve.loop->after > 0)};
}

std::optional<KeySpan> span_of(const Switch& channel) { return span_of(channel.channel()); }

}  // namespace

bool KeySpan::is_outside(const FrameSpan& played) const {
  return count >= 2 &&
         ((last < played.first && holds_after) || (first > played.last && holds_before));
}

std::string KeySpan::text() const { return fmt::format("at frames {:.6g} to {:.6g}", first, last); }

std::optional<KeySpan> keys_of(const Channel<1>& channel) { return span_of(channel); }

std::optional<KeySpan> keys_of(const Switch& channel) { return span_of(channel); }

std::optional<KeySpan> keys_of(const NamedChannel& channel) {
  return std::visit([](const auto* of) { return span_of(*of); }, channel.channel);
}

FrameSpan solved_frames(const FrameSpan& played) {
  return {played.first, std::max(played.first, played.last - 1)};
}

FrameRanges ranges_of(const FrameSpan& frames) {
  FrameRanges ranges;
  for (int frame = frames.first; frame <= frames.last; ++frame) ranges.add(frame);
  return ranges;
}

bool is_on(const Switch& enabled) { return enabled.is_animated() || enabled.at(0); }

bool is_solved(const Surface& surface) { return surface.enabled && !surface.is_driven(); }

bool is_inertia(const Force& force) { return std::holds_alternative<InertiaChannels>(force.kind); }

bool stands_still(const Surface& surface, const FrameSpan& frames) {
  if (surface.is_animated()) return false;
  const TransformChannels& of = surface.transform;
  if (!of.translate.is_animated() && !of.rotate.is_animated() && !of.scale.is_animated())
    return true;
  const Transform first = of.at(frames.first);
  for (int frame = frames.first + 1; frame <= frames.last; ++frame) {
    const Transform now = of.at(frame);
    if (now.linear != first.linear || now.translation != first.translation) return false;
  }
  return true;
}

std::string names_text(const std::vector<const Surface*>& surfaces) {
  constexpr std::size_t most = 6;
  std::vector<std::string> names;
  for (const Surface* surface : surfaces) {
    if (names.size() == most) {
      names.push_back(fmt::format("{} more", surfaces.size() - most));
      break;
    }
    names.push_back(fmt::format("\"{}\"", surface->name));
  }
  return in_words(names);
}

}  // namespace pliant
