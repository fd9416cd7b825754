#pragma once

#include <optional>
#include <variant>

#include "pliant/timeline/channel.hpp"
#include "pliant/timeline/path.hpp"

namespace pliant {

/// A path, and the share of its length at each frame.
struct PathMotion {
  Path path;
  Channel<1> progress = 0;  ///< share of the length, 0 to 1

  friend bool operator==(const PathMotion&, const PathMotion&) = default;
};

/// A position over time: a constant, a curve, or a motion along a path.
class PositionChannel {
 public:
  PositionChannel(Value<3> constant = {});  // NOLINT: a constant is a position
  PositionChannel(Curve<3> curve);          // NOLINT: a curve is a position
  PositionChannel(Channel<3> channel);      // NOLINT: a channel is a position
  PositionChannel(PathMotion motion);       // NOLINT: a motion along a path is a position
  PositionChannel(const PositionChannel&);
  PositionChannel(PositionChannel&&) noexcept;
  PositionChannel& operator=(const PositionChannel&);
  PositionChannel& operator=(PositionChannel&&) noexcept;
  ~PositionChannel();

  /// The position at a frame [length]. Requires: finite.
  Value<3> at(double frame) const;

  bool is_animated() const;

  /// Adjusts its value at every frame. Requires: no component is adjusted already, unless it is
  /// constant.
  void adjust(const Adjustments<3>& adjustments);

  /// What it is adjusted by; null: nothing, or it is constant.
  const Adjustments<3>* adjustments() const;

  /// The path; null: a constant or curve.
  const PathMotion* path() const { return std::get_if<PathMotion>(&way_); }

  PathMotion* path() { return std::get_if<PathMotion>(&way_); }

  /// The constant or curve; null: a path.
  const Channel<3>* channel() const { return std::get_if<Channel<3>>(&way_); }
  Channel<3>* channel() { return std::get_if<Channel<3>>(&way_); }

  friend bool operator==(const PositionChannel&, const PositionChannel&) = default;

 private:
  std::variant<Channel<3>, PathMotion> way_;
  std::optional<Adjustments<3>> adjustments_;  // of a path
};

}  // namespace pliant
