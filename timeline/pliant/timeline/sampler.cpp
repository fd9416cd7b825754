#include "pliant/timeline/sampler.hpp"

#include "pliant/timeline/extrapolated_evaluation.hpp"

namespace pliant {

template <int D>
std::size_t Sampler<D>::locate(double frame) {
  // A segment holds its start but not its end: what the search would find.
  const auto& track = curve_->compiled_.track;
  const auto& segments = track.segments;
  if (segment_ < segments.size() && frame >= segments[segment_].start) {
    if (frame < segments[segment_].end) return segment_;
    const std::size_t next = segment_ + 1;
    if (next < segments.size() && frame < segments[next].end) return segment_ = next;
  }
  return segment_ = track.segment_at(frame);
}

template <int D>
Value<D> Sampler<D>::value(double frame) {
  return curve_->compiled_.value(frame, timeline::Limit::At,
                                 [this](double inner) { return locate(inner); });
}

template <int D>
Value<D> Sampler<D>::left_value(double frame) {
  return curve_->compiled_.value(frame, timeline::Limit::Left,
                                 [this](double inner) { return locate(inner); });
}

template <int D>
Value<D> Sampler<D>::velocity(double frame) {
  return curve_->compiled_.velocity(frame, timeline::Limit::Right,
                                    [this](double inner) { return locate(inner); });
}

template <int D>
Value<D> Sampler<D>::left_velocity(double frame) {
  return curve_->compiled_.velocity(frame, timeline::Limit::Left,
                                    [this](double inner) { return locate(inner); });
}

template class Sampler<1>;
template class Sampler<3>;

}  // namespace pliant
