#include "viewer/channels.hpp"

#include <algorithm>
#include <type_traits>
#include <variant>
#include <vector>

#include "pliant/scene/channels.hpp"
#include "pliant/timeline/sampler.hpp"

namespace pliant::viewer {
namespace {

std::string_view name_of(Interpolation::Kind kind) {
  switch (kind) {
    case Interpolation::Kind::Step:
      return "step";
    case Interpolation::Kind::StepNext:
      return "stepNext";
    case Interpolation::Kind::Linear:
      return "linear";
    case Interpolation::Kind::Bezier:
      return "bezier";
    case Interpolation::Kind::Easing:
      return "easing";
    case Interpolation::Kind::CubicBezier:
      return "cubicBezier";
  }
  return "bezier";
}

// A frame and its value, as one row.
template <int D>
Json row(double frame, const Value<D>& value) {
  Json numbers = {frame};
  for (const double component : value) numbers.push_back(component);
  return numbers;
}

// Every frame from `first` to `last`, as the page shows their values, and enough frames in between
// for a smooth line.
std::vector<double> sampled_frames(int first, int last) {
  constexpr int most = 2000;
  const int between = std::clamp(most / std::max(last - first, 1), 1, 8);
  std::vector<double> frames;
  for (int frame = first; frame < last; ++frame) {
    for (int k = 0; k < between; ++k) frames.push_back(frame + static_cast<double>(k) / between);
  }
  frames.push_back(last);
  return frames;
}

template <int D>
Json points_of(const Curve<D>& curve, int first, int last) {
  std::vector<double> frames = sampled_frames(first, last);
  for (const Key<D>& key : curve.keys().keys) {
    if (key.frame >= first && key.frame <= last) frames.push_back(key.frame);
  }
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  Json points = Json::array();
  Sampler<D> sampler(curve);
  for (const double frame : frames) {
    const Value<D> arrived = sampler.left_value(frame), value = sampler.value(frame);
    if (arrived != value) points.push_back(row<D>(frame, arrived));
    points.push_back(row<D>(frame, value));
  }
  return points;
}

template <int D>
Json channel_json(const std::string& path, const Curve<D>& curve, const FrameSpan& range) {
  Json keys = Json::array(), handles = Json::array();
  for (const Key<D>& key : curve.keys().keys) {
    keys.push_back({{"at", row<D>(key.frame, key.value)}, {"next", name_of(key.next.kind)}});
  }
  for (const KeyHandle<D>& handle : curve.handles()) {
    handles.push_back({{"key", row<D>(handle.key_frame, handle.key_value)},
                       {"tip", row<D>(handle.frame, handle.value)}});
  }
  return {{"path", path},
          {"components", D},
          {"keys", keys},
          {"handles", handles},
          {"points", points_of(curve, range.first, range.last)}};
}

}  // namespace

Result<Json> view_channels(const Scene& scene, const FrameSpan& frames,
                           const StopRequest& should_stop) {
  Json channels = Json::array();
  for (const NamedChannel& named : channels_of(scene)) {
    if (!named.is_animated()) continue;
    if (is_stopped(should_stop)) return interrupted();
    std::visit(
        [&](const auto* held) {
          if constexpr (std::is_same_v<decltype(held), const Switch*>) {
            channels.push_back(channel_json(named.path, held->channel().curve(), frames));
          } else {
            channels.push_back(channel_json(named.path, held->curve(), frames));
          }
        },
        named.channel);
  }
  return channels;
}

}  // namespace pliant::viewer
