#pragma once

#include <utility>
#include <variant>

#include "pliant/timeline/channel.hpp"
#include "pliant/timeline/path.hpp"

namespace pliant {

/// A path, and the share of its length at each frame.
struct PathMotion {
  Path path;
  Channel<1> progress = 0;  ///< share of the length, 0 to 1
};

/// A position over time: a constant, a curve, or a motion along a path.
class PositionChannel {
 public:
  PositionChannel(Value<3> constant = {}) : way_(Channel<3>(constant)) {}  // NOLINT: is a position
  PositionChannel(Curve<3> curve) : way_(Channel<3>(std::move(curve))) {}  // NOLINT: likewise
  PositionChannel(Channel<3> channel) : way_(std::move(channel)) {}        // NOLINT: likewise
  PositionChannel(PathMotion motion) : way_(std::move(motion)) {}          // NOLINT: likewise

  /// The position at a frame [length]. Requires: finite.
  Value<3> at(double frame) const {
    if (const auto* motion = path()) return motion->path.at(motion->progress.at(frame)[0]);
    return channel()->at(frame);
  }

  bool is_animated() const {
    return path() ? path()->progress.is_animated() : channel()->is_animated();
  }

  /// The path; null: a constant or curve.
  const PathMotion* path() const { return std::get_if<PathMotion>(&way_); }

  /// The constant or curve; null: a path.
  const Channel<3>* channel() const { return std::get_if<Channel<3>>(&way_); }

 private:
  std::variant<Channel<3>, PathMotion> way_;
};

}  // namespace pliant
