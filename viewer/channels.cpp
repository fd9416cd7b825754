#include "viewer/channels.hpp"

#include <algorithm>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "pliant/scene/channels.hpp"
#include "pliant/scene/format/key_words.hpp"
#include "pliant/timeline/sampler.hpp"

namespace pliant::viewer {
namespace {

// A frame and its value, as one row.
template <int D>
Json row(double frame, const Value<D>& value) {
  Json numbers = {frame};
  for (const double component : value) numbers.push_back(component);
  return numbers;
}

// Whether the curve is made of straight lines from `frame` to the next one.
template <int D>
bool is_straight(const CurveKeys<D>& curve, double frame) {
  const auto& keys = curve.keys;
  if (curve.loop) return false;
  auto key = std::ranges::upper_bound(keys, frame, {}, &Key<D>::frame);
  if (key == keys.begin()) return false;
  const auto is_line = [](const Key<D>& from) {
    return from.next.kind == Interpolation::Kind::Linear ||
           from.next.kind == Interpolation::Kind::Step;
  };
  while (key != keys.end() && is_line(*std::prev(key)) && key->frame < frame + 1) ++key;
  return key != keys.end() && is_line(*std::prev(key));
}

// Every frame from `first` to `last`, as the page shows their values, the keys, and enough frames
// in between for a smooth line.
template <int D>
std::vector<double> sampled_frames(const CurveKeys<D>& curve, int first, int last) {
  constexpr int most = 2000;
  const int between = std::clamp(most / std::max(last - first, 1), 1, 8);
  std::vector<double> frames;
  for (int frame = first; frame < last; ++frame) {
    const int parts = between > 1 && is_straight(curve, frame) ? 1 : between;
    for (int k = 0; k < parts; ++k) frames.push_back(frame + static_cast<double>(k) / parts);
  }
  frames.push_back(last);
  for (const Key<D>& key : curve.keys) {
    if (key.frame >= first && key.frame <= last) frames.push_back(key.frame);
  }
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

template <int D>
Json points_of(const Curve<D>& curve, int first, int last) {
  Json points = Json::array();
  Sampler<D> sampler(curve);
  for (const double frame : sampled_frames(curve.keys(), first, last)) {
    const Value<D> arrived = sampler.left_value(frame), value = sampler.value(frame);
    if (arrived != value) points.push_back(row<D>(frame, arrived));
    points.push_back(row<D>(frame, value));
  }
  return points;
}

// `auto`, `0.5`, `handle`.
template <int D>
std::string tangent_word(const Tangent<D>& tangent, xml::ValueKind kind) {
  return tangent.kind == Tangent<D>::Kind::Handle ? "handle" : xml::text_of(tangent, kind);
}

template <int D>
Json channel_json(const std::string& path, const Curve<D>& curve, xml::ValueKind kind,
                  const FrameSpan& range) {
  const CurveKeys<D>& author = curve.keys();
  Json channel = {{"path", path}, {"components", D}};
  if (kind == xml::ValueKind::Boolean) channel["isSwitch"] = true;
  Json keys = Json::array(), handles = Json::array();
  for (const Key<D>& key : author.keys) {
    keys.push_back({{"at", row<D>(key.frame, key.value)},
                    {"next", xml::text_of(key.next)},
                    {"in", tangent_word(key.in, kind)},
                    {"out", tangent_word(key.out, kind)}});
  }
  channel["keys"] = std::move(keys);
  channel["before"] = xml::text_of(author.before, kind);
  channel["after"] = xml::text_of(author.after, kind);
  if (const auto& loop = author.loop) {
    channel["loop"] = {{"from", loop->from},
                       {"to", loop->to},
                       {"before", loop->before},
                       {"after", loop->after},
                       {"offset", loop->offset}};
  }
  bool is_out = false;
  for (const KeyHandle<D>& handle : curve.handles()) {
    is_out = !is_out;  // both of each segment
    handles.push_back({{"key", row<D>(handle.key_frame, handle.key_value)},
                       {"tip", row<D>(handle.frame, handle.value)},
                       {"side", is_out ? "out" : "in"}});
  }
  channel["handles"] = std::move(handles);
  channel["points"] = points_of(curve, range.first, range.last);
  return channel;
}

}  // namespace

Result<Json> view_channels(const Scene& scene, const FrameSpan& frames,
                           const StopRequest& should_stop) {
  Json channels = Json::array();
  for (const NamedChannel& named : channels_of(scene)) {
    if (!named.is_animated()) continue;
    if (is_stopped(should_stop)) return interrupted();
    std::visit(
        [&]<class Held>(const Held* held) {
          using xml::ValueKind;
          if constexpr (std::is_same_v<Held, Switch>) {
            channels.push_back(
                channel_json(named.path, held->channel().curve(), ValueKind::Boolean, frames));
          } else {
            constexpr auto kind =
                std::is_same_v<Held, Channel<1>> ? ValueKind::Number : ValueKind::Vector;
            channels.push_back(channel_json(named.path, held->curve(), kind, frames));
          }
        },
        named.channel);
  }
  return channels;
}

}  // namespace pliant::viewer
