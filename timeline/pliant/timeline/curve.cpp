#include "pliant/timeline/curve.hpp"

#include <utility>

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
struct Curve<D>::Parts {
  CurveKeys<D> keys;
  timeline::Compiled<D> compiled;
};

template <int D>
tl::expected<Curve<D>, CurveError> Curve<D>::make(CurveKeys<D> keys) {
  auto compiled = timeline::compile(keys);
  if (!compiled) return tl::unexpected(compiled.error());
  return Curve(Parts{std::move(keys), *std::move(compiled)});
}

template <int D>
Curve<D>::Curve(Parts parts) : parts_(std::make_unique<const Parts>(std::move(parts))) {}

template <int D>
Curve<D>::Curve(const Curve& other) : Curve(Parts(*other.parts_)) {}

template <int D>
Curve<D>::Curve(Curve&&) noexcept = default;

template <int D>
Curve<D>& Curve<D>::operator=(const Curve& other) {
  *this = Curve(other);
  return *this;
}

template <int D>
Curve<D>& Curve<D>::operator=(Curve&&) noexcept = default;

template <int D>
Curve<D>::~Curve() = default;

template <int D>
Value<D> Curve<D>::value(double frame) const {
  // Between the keys no side is involved.
  const timeline::Track<D>& track = compiled().track;
  if (frame > track.first() && frame < track.last()) {
    const timeline::Segment<D>& here = track.segments[track.segment_at(frame)];
    if (frame != here.start) return track.value_in(here, frame);
  }
  return compiled().value(frame, timeline::Limit::At, search(compiled().track));
}

template <int D>
Value<D> Curve<D>::left_value(double frame) const {
  return compiled().value(frame, timeline::Limit::Left, search(compiled().track));
}

template <int D>
Value<D> Curve<D>::velocity(double frame) const {
  return compiled().velocity(frame, timeline::Limit::Right, search(compiled().track));
}

template <int D>
Value<D> Curve<D>::left_velocity(double frame) const {
  return compiled().velocity(frame, timeline::Limit::Left, search(compiled().track));
}

template <int D>
ValueRange<D> Curve<D>::range(double from, double to) const {
  return compiled().bounds(from, to);
}

template <int D>
const timeline::Extrapolated<D>& Curve<D>::compiled() const {
  return parts_->compiled.curve;
}

template <int D>
const CurveKeys<D>& Curve<D>::keys() const {
  return parts_->keys;
}

template <int D>
const std::vector<CurveNote>& Curve<D>::notes() const {
  return parts_->compiled.notes;
}

template <int D>
const std::vector<KeyHandle<D>>& Curve<D>::handles() const {
  return parts_->compiled.handles;
}

template class Curve<1>;
template class Curve<3>;

}  // namespace pliant
