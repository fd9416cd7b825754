#include "pliant/timeline/edit/split.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/timeline/overshoot.hpp"

namespace pliant::timeline {

namespace {

/// Frames from one end of a segment over the parameter from there.
template <int D>
Cubic time_from_end(const Track<D>& track, std::size_t k, int end) {
  const Segment<D>& segment = track.segments[k];
  if (segment.kind == Segment<D>::Kind::Bezier) return track.times[segment.extra].from_end(end);
  return {0, segment.length, 0, 0};
}

template <int D>
Handle<D> handle_of(const Track<D>& track, std::size_t k, int end) {
  Handle<D> handle;
  handle.frames = time_from_end(track, k, end).c1 / 3;
  for (int c = 0; c < D; ++c) handle.value[c] = track.segments[k].ends[end][c].c1 / 3;
  return handle;
}

template <int D>
Handle<D> scaled(const Handle<D>& handle, double factor) {
  Handle<D> result;
  result.frames = factor * handle.frames;
  for (int c = 0; c < D; ++c) result.value[c] = factor * handle.value[c];
  return result;
}

/// A segment to be written: its span and the values at its ends.
template <int D>
struct Extent {
  double span;
  Value<D> start;
  Value<D> end;
};

/// If one end has no handle and the handle of the other reaches exactly to it, the slope there
/// depends on exact zeros of second order (0/0, or infinite): restores these zeros.
template <int D>
void reach_exactly(const Handle<D>& none, Handle<D>& other, const Extent<D>& extent,
                   double direction, double tolerance) {
  if (none.frames != 0) return;
  if (std::fabs(other.frames - extent.span) <= tolerance * extent.span) other.frames = extent.span;
  for (int c = 0; c < D; ++c) {
    const double change = direction * (extent.end[c] - extent.start[c]);
    const double size = std::max(std::fabs(extent.end[c]), std::fabs(extent.start[c]));
    if (none.value[c] == 0 && std::fabs(other.value[c] - change) <= tolerance * size) {
      other.value[c] = change;
    }
  }
}

/// Corrects handles that rounding may have moved outside the ellipse of eq. 6, or next to a limit.
template <int D>
Handles<D> settled(Handles<D> handles, const Extent<D>& extent, double tolerance) {
  const Lengths lengths{handles.start.frames, handles.end.frames};
  const Lengths result = corrected(lengths, extent.span, Overshoot::Limit);
  if (result.start != lengths.start && lengths.start > 0) {
    handles.start = scaled(handles.start, result.start / lengths.start);
  }
  if (result.end != lengths.end && lengths.end > 0) {
    handles.end = scaled(handles.end, result.end / lengths.end);
  }
  reach_exactly(handles.start, handles.end, extent, -1, tolerance);
  reach_exactly(handles.end, handles.start, extent, 1, tolerance);
  return handles;
}

}  // namespace

template <int D>
Tangent<D> Handle<D>::as_tangent(bool is_out) const {
  Tangent<D> tangent;
  tangent.kind = Tangent<D>::Kind::Handle;
  tangent.handle_frames = is_out ? frames : -frames;
  tangent.handle_value = value;
  return tangent;
}

template <int D>
Handles<D> handles_of(const Track<D>& track, std::size_t k) {
  return {handle_of(track, k, 0), handle_of(track, k, 1)};
}

template <int D>
Split<D> split(const Track<D>& track, std::size_t k, double frame) {
  const Segment<D>& segment = track.segments[k];
  // With q from the nearer end: the handle there shrinks by the factor q, the far one by 1-q, and
  // between them is the derivative of the curve over a third of either part.
  int near = 0;
  double q = (frame - segment.start) / segment.length;
  if (segment.kind == Segment<D>::Kind::Bezier) {
    const TimeCubic::Place place = track.times[segment.extra].place_of(frame);
    near = place.end;
    q = place.q + place.correction;
  } else if (q > 0.5) {
    near = 1;
    q = (segment.end - frame) / segment.length;
  }
  Handle<D> onward;  // from the new key away from the near end
  onward.frames = std::max(0.0, time_from_end(track, k, near).slope(q) / 3);
  for (int c = 0; c < D; ++c) onward.value[c] = segment.ends[near][c].slope(q) / 3;
  Handle<D> back = scaled(onward, q);
  for (double& each : back.value) each = 0 - each;

  const Handles<D> near_part{scaled(handle_of(track, k, near), q), back};
  const Handles<D> far_part{scaled(onward, 1 - q), scaled(handle_of(track, k, 1 - near), 1 - q)};
  Split<D> result{near_part, far_part};
  if (near == 1) result = {{far_part.end, far_part.start}, {near_part.end, near_part.start}};
  constexpr double tolerance = 8 * std::numeric_limits<double>::epsilon();
  const Value<D> value = track.value(frame, Limit::At, k);
  result.left = settled<D>(result.left, {frame - segment.start, track.values[k], value}, tolerance);
  result.right =
      settled<D>(result.right, {segment.end - frame, value, track.arrivals[k + 1]}, tolerance);
  return result;
}

template <int D>
std::optional<Handles<D>> joined(const Track<D>& track, std::size_t k) {
  const Handles<D> left = handles_of(track, k);
  const Handles<D> right = handles_of(track, k + 1);
  double before = left.end.frames;
  double after = right.start.frames;
  if (before + after == 0) {  // vertical: the values decide
    for (int c = 0; c < D; ++c) {
      before += std::fabs(left.end.value[c]);
      after += std::fabs(right.start.value[c]);
    }
  }
  const double q = before / (before + after);
  if (!(q > 0 && q < 1)) return std::nullopt;

  const double start = track.frames[k];
  const double length = track.frames[k + 2] - start;
  const Handles<D> whole{scaled(left.start, 1 / q), scaled(right.end, 1 / (1 - q))};
  // The whole segment at q, and its derivative by q, must give the key and its handles. One part in
  // 1e11 is far above the rounding of a split and far below any visible change.
  constexpr double tolerance = 1e-11;
  const double p = 1 - q;
  const auto fits = [&](double first, double second, double last, double at, double handle_before,
                        double handle_after, double size) {
    const double place = 3 * first * q * p * p + 3 * second * q * q * p + last * q * q * q;
    const double slope = first * p * p + 2 * (second - first) * q * p + (last - second) * q * q;
    return std::fabs(place - at) <= tolerance * size &&
           std::fabs(slope * q - handle_before) <= tolerance * size &&
           std::fabs(slope * p - handle_after) <= tolerance * size;
  };
  bool is_whole =
      fits(whole.start.frames, length - whole.end.frames, length, track.frames[k + 1] - start,
           left.end.frames, right.start.frames, length + std::fabs(track.frames[k + 1]) * 1e-4);
  for (int c = 0; c < D; ++c) {
    const double first = track.values[k][c];
    const double last = track.arrivals[k + 2][c];
    const double size = std::max({std::fabs(first), std::fabs(last),
                                  std::fabs(whole.start.value[c]), std::fabs(whole.end.value[c])});
    is_whole = is_whole &&
               fits(whole.start.value[c], last + whole.end.value[c] - first, last - first,
                    track.values[k + 1][c] - first, -left.end.value[c], right.start.value[c], size);
  }
  if (!is_whole) return std::nullopt;
  return settled<D>(whole, {length, track.values[k], track.arrivals[k + 2]}, tolerance);
}

template struct Handle<1>;
template struct Handle<3>;
template Handles<1> handles_of(const Track<1>&, std::size_t);
template Handles<3> handles_of(const Track<3>&, std::size_t);
template Split<1> split(const Track<1>&, std::size_t, double);
template Split<3> split(const Track<3>&, std::size_t, double);
template std::optional<Handles<1>> joined(const Track<1>&, std::size_t);
template std::optional<Handles<3>> joined(const Track<3>&, std::size_t);

}  // namespace pliant::timeline
