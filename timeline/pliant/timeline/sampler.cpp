#include "pliant/timeline/sampler.hpp"

#include "pliant/timeline/extrapolated_evaluation.hpp"
#include "pliant/timeline/track_evaluation.hpp"

namespace pliant {

template <int D>
Sampler<D>::Sampler(const Curve<D>& curve)
    : curve_(&curve.compiled()), adjustments_(curve.adjustments()) {
  const auto& segments = curve_->track.segments;
  if (segments.empty()) return;
  here_ = segments.data();
  last_ = here_ + (segments.size() - 1);
}

template <int D>
std::size_t Sampler<D>::locate(double frame) {
  const auto& track = curve_->track;
  if (here_ == nullptr) return 0;
  // A segment includes its start but not its end, as in the search.
  if (frame >= here_->end && here_ != last_) ++here_;
  const bool is_here = frame >= here_->start && frame < here_->end;
  if (!is_here) here_ = track.segments.data() + track.segment_at(frame);
  return static_cast<std::size_t>(here_ - track.segments.data());
}

template <int D>
Value<D> Sampler<D>::value(double frame) {
  if (adjustments_ != nullptr) return adjusted_anywhere(frame);
  // Playback: between the same two keys as before, or the next two.
  if (here_ != nullptr) {
    if (frame >= here_->end && here_ != last_) ++here_;
    if (frame > here_->start && frame < here_->end) {
      return curve_->track.value_in(*here_, frame);
    }
  }
  return value_anywhere(frame);
}

template <int D>
Value<D> Sampler<D>::value_anywhere(double frame) {
  return curve_->value(frame, timeline::Limit::At, [this](double inner) { return locate(inner); });
}

template <int D>
Value<D> Sampler<D>::adjusted_anywhere(double frame) {
  return adjusted_value<D>(*adjustments_, value_anywhere(frame));
}

template <int D>
Value<D> Sampler<D>::left_value(double frame) {
  const Value<D> plain =
      curve_->value(frame, timeline::Limit::Left, [this](double inner) { return locate(inner); });
  return adjustments_ ? adjusted_value<D>(*adjustments_, plain) : plain;
}

template <int D>
Value<D> Sampler<D>::velocity(double frame) {
  const Value<D> plain = curve_->velocity(frame, timeline::Limit::Right,
                                          [this](double inner) { return locate(inner); });
  return adjustments_ ? adjusted_difference<D>(*adjustments_, plain) : plain;
}

template <int D>
Value<D> Sampler<D>::left_velocity(double frame) {
  const Value<D> plain = curve_->velocity(frame, timeline::Limit::Left,
                                          [this](double inner) { return locate(inner); });
  return adjustments_ ? adjusted_difference<D>(*adjustments_, plain) : plain;
}

template class Sampler<1>;
template class Sampler<3>;

}  // namespace pliant
