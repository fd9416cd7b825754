#include "pliant/timeline/position.hpp"

#include <utility>

#include "pliant/core/expects.hpp"

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
  if (const auto* motion = path()) {
    const Value<3> place = motion->path.at(motion->progress.at(frame)[0]);
    return adjustments_ ? adjusted_value<3>(*adjustments_, place) : place;
  }
  return channel()->at(frame);
}

void PositionChannel::adjust(const Adjustments<3>& adjustments) {
  if (auto* const own = channel()) return own->adjust(adjustments);
  PLIANT_EXPECTS(!adjustments_ || !overlap<3>(*adjustments_, adjustments));
  adjustments_ = adjustments_ ? both<3>(*adjustments_, adjustments) : adjustments;
}

const Adjustments<3>* PositionChannel::adjustments() const {
  if (const auto* own = channel()) return own->adjustments();
  return adjustments_ ? &*adjustments_ : nullptr;
}

bool PositionChannel::is_animated() const {
  return path() ? path()->progress.is_animated() : channel()->is_animated();
}

}  // namespace pliant
