#include "pliant/timeline/curve.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/timeline/compile.hpp"
#include "pliant/timeline/extrapolated_evaluation.hpp"
#include "pliant/timeline/track_evaluation.hpp"

namespace pliant {

namespace {

template <int D>
auto search(const timeline::Track<D>& track) {
  return [&track](double frame) { return track.segment_at(frame); };
}

template <int D>
CurveKeys<D> adjusted_keys(CurveKeys<D> keys, const Adjustments<D>& adjustments) {
  const auto value = [&](Value<D>& of) { of = adjusted_value<D>(adjustments, of); };
  const auto difference = [&](Value<D>& of) { of = adjusted_difference<D>(adjustments, of); };
  for (Key<D>& key : keys.keys) {
    value(key.value);
    if (key.left) value(*key.left);
    for (Tangent<D>* const tangent : {&key.in, &key.out}) {
      difference(tangent->slope);
      difference(tangent->handle_value);
    }
    // A number for all components.
    if (D == 1 && key.next.amplitude)
      key.next.amplitude = std::abs(adjustments[0].of_difference(*key.next.amplitude));
  }
  difference(keys.before.slope);
  difference(keys.after.slope);
  if (keys.loop) difference(keys.loop->offset);
  return keys;
}

}  // namespace

template <int D>
struct Curve<D>::Shared {
  CurveKeys<D> keys;
  timeline::Compiled<D> compiled;
  std::optional<Adjustments<D>> adjustments = {};
  std::shared_ptr<const Shared> unadjusted = {};  // null: this one
};

template <int D>
Checked<Curve<D>> Curve<D>::make(CurveKeys<D> keys, const StopRequest& should_stop) {
  auto compiled = timeline::compile(keys, should_stop);
  if (!compiled) return tl::unexpected(compiled.error());
  return Curve(Shared{std::move(keys), *std::move(compiled)});
}

template <int D>
Curve<D>::Curve(Shared shared) : shared_(std::make_shared<const Shared>(std::move(shared))) {}

template <int D>
Curve<D>::Curve(std::shared_ptr<const Shared> shared) : shared_(std::move(shared)) {}

template <int D>
Curve<D>::Curve(const Curve&) = default;

template <int D>
Curve<D>::Curve(Curve&&) noexcept = default;

template <int D>
Curve<D>& Curve<D>::operator=(const Curve&) = default;

template <int D>
Curve<D>& Curve<D>::operator=(Curve&&) noexcept = default;

template <int D>
Curve<D>::~Curve() = default;

template <int D>
Curve<D> Curve<D>::adjusted(const Adjustments<D>& adjustments) const {
  PLIANT_EXPECTS(!this->adjustments() || !overlap<D>(*this->adjustments(), adjustments));
  Shared shared = *shared_;
  shared.keys = adjusted_keys<D>(std::move(shared.keys), adjustments);
  for (KeyHandle<D>& handle : shared.compiled.handles) {
    handle.key_value = adjusted_value<D>(adjustments, handle.key_value);
    handle.value = adjusted_value<D>(adjustments, handle.value);
  }
  if (!shared.unadjusted) shared.unadjusted = shared_;
  shared.adjustments = shared.adjustments ? both<D>(*shared.adjustments, adjustments) : adjustments;
  return Curve(std::move(shared));
}

template <int D>
const Adjustments<D>* Curve<D>::adjustments() const {
  return shared_->adjustments ? &*shared_->adjustments : nullptr;
}

template <int D>
Curve<D> Curve<D>::unadjusted() const {
  return shared_->unadjusted ? Curve(shared_->unadjusted) : *this;
}

template <int D>
Value<D> Curve<D>::value(double frame) const {
  const auto plain = [&] {
    // Between the keys no side is involved.
    const timeline::Track<D>& track = compiled().track;
    if (frame > track.first() && frame < track.last()) {
      const timeline::Segment<D>& here = track.segments[track.segment_at(frame)];
      if (frame != here.start) return track.value_in(here, frame);
    }
    return compiled().value(frame, timeline::Limit::At, search(compiled().track));
  };
  const Adjustments<D>* const adjusts = adjustments();
  return adjusts ? adjusted_value<D>(*adjusts, plain()) : plain();
}

template <int D>
Value<D> Curve<D>::left_value(double frame) const {
  const Value<D> plain = compiled().value(frame, timeline::Limit::Left, search(compiled().track));
  return adjustments() ? adjusted_value<D>(*adjustments(), plain) : plain;
}

template <int D>
Value<D> Curve<D>::velocity(double frame) const {
  const Value<D> plain =
      compiled().velocity(frame, timeline::Limit::Right, search(compiled().track));
  return adjustments() ? adjusted_difference<D>(*adjustments(), plain) : plain;
}

template <int D>
Value<D> Curve<D>::left_velocity(double frame) const {
  const Value<D> plain =
      compiled().velocity(frame, timeline::Limit::Left, search(compiled().track));
  return adjustments() ? adjusted_difference<D>(*adjustments(), plain) : plain;
}

template <int D>
ValueRange<D> Curve<D>::range(double from, double to) const {
  const ValueRange<D> plain = compiled().bounds(from, to);
  if (!adjustments()) return plain;
  const Value<D> low = adjusted_value<D>(*adjustments(), plain.low);
  ValueRange<D> range{low, low};
  range.add(adjusted_value<D>(*adjustments(), plain.high));
  return range;
}

template <int D>
const timeline::Extrapolated<D>& Curve<D>::compiled() const {
  return shared_->compiled.curve;
}

template <int D>
bool Curve<D>::is_equal(const Curve& other) const {
  return shared_ == other.shared_ ||
         (keys() == other.keys() && shared_->adjustments == other.shared_->adjustments);
}

template <int D>
const CurveKeys<D>& Curve<D>::keys() const {
  return shared_->keys;
}

template <int D>
const std::vector<CurveNote>& Curve<D>::notes() const {
  return shared_->compiled.notes;
}

template <int D>
const std::vector<KeyHandle<D>>& Curve<D>::handles() const {
  return shared_->compiled.handles;
}

template class Curve<1>;
template class Curve<3>;

}  // namespace pliant
