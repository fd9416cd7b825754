#include "pliant/timeline/position.hpp"

#include <utility>

namespace pliant {

PositionChannel::PositionChannel(Value<3> constant) : way_(Channel<3>(constant)) {}
PositionChannel::PositionChannel(Curve<3> curve) : way_(Channel<3>(std::move(curve))) {}
PositionChannel::PositionChannel(Channel<3> channel) : way_(std::move(channel)) {}
PositionChannel::PositionChannel(PathMotion motion) : way_(std::move(motion)) {}

PositionChannel::PositionChannel(const PositionChannel&) = default;
PositionChannel::PositionChannel(PositionChannel&&) noexcept = default;
PositionChannel& PositionChannel::operator=(const PositionChannel&) = default;
PositionChannel& PositionChannel::operator=(PositionChannel&&) noexcept = default;
PositionChannel::~PositionChannel() = default;

Value<3> PositionChannel::at(double frame) const {
  if (const auto* motion = path()) return motion->path.at(motion->progress.at(frame)[0]);
  return channel()->at(frame);
}

bool PositionChannel::is_animated() const {
  return path() ? path()->progress.is_animated() : channel()->is_animated();
}

}  // namespace pliant
