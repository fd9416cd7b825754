#include "pliant/timeline/curve.hpp"

#include "pliant/timeline/compile.hpp"
#include "pliant/timeline/extrapolated_evaluation.hpp"
#include "pliant/timeline/track_evaluation.hpp"

namespace pliant {

namespace {

template <int D>
auto search(const timeline::Track<D>& track) {
  return [&track](double frame) { return track.segment_at(frame); };
}

}  // namespace

template <int D>
tl::expected<Curve<D>, CurveError> Curve<D>::make(CurveKeys<D> keys) {
  auto compiled = timeline::compile(keys);
  if (!compiled) return tl::unexpected(compiled.error());
  return Curve(std::move(keys), *std::move(compiled));
}

template <int D>
Curve<D>::Curve(CurveKeys<D> keys, timeline::Compiled<D> compiled)
    : keys_(std::move(keys)),
      compiled_(std::move(compiled.curve)),
      notes_(std::move(compiled.notes)),
      handles_(std::move(compiled.handles)) {}

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
Value<D> Curve<D>::value(double frame) const {
  // Between the keys no side is involved.
  const timeline::Track<D>& track = compiled_.track;
  if (frame > track.first() && frame < track.last()) {
    const timeline::Segment<D>& here = track.segments[track.segment_at(frame)];
    if (frame != here.start) return track.value_in(here, frame);
  }
  return compiled_.value(frame, timeline::Limit::At, search(compiled_.track));
}

template <int D>
Value<D> Curve<D>::left_value(double frame) const {
  return compiled_.value(frame, timeline::Limit::Left, search(compiled_.track));
}

template <int D>
Value<D> Curve<D>::velocity(double frame) const {
  return compiled_.velocity(frame, timeline::Limit::Right, search(compiled_.track));
}

template <int D>
Value<D> Curve<D>::left_velocity(double frame) const {
  return compiled_.velocity(frame, timeline::Limit::Left, search(compiled_.track));
}

template <int D>
ValueRange<D> Curve<D>::range(double from, double to) const {
  return compiled_.bounds(from, to);
}

template class Curve<1>;
template class Curve<3>;

}  // namespace pliant
