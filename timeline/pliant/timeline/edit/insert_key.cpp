#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "pliant/timeline/compile.hpp"
#include "pliant/timeline/edit/edit.hpp"
#include "pliant/timeline/edit/preserve.hpp"
#include "pliant/timeline/edit/split.hpp"
#include "pliant/timeline/number_text.hpp"

namespace pliant {

namespace timeline {

namespace {

std::string name_of(const Interpolation& easing) {
  constexpr const char* names[] = {"sine", "quad", "cubic", "quart",  "quint",
                                   "expo", "circ", "back",  "bounce", "elastic"};
  constexpr const char* sides[] = {"In", "Out", "InOut"};
  return std::string(names[static_cast<int>(easing.ease)]) + sides[static_cast<int>(easing.side)];
}

/// Whether an easing is made of cubics (docs/timeline.md, eq. 16, 19, 20).
bool is_row_of_cubics(Ease ease) {
  return ease == Ease::Quad || ease == Ease::Cubic || ease == Ease::Back || ease == Ease::Bounce;
}

/// The places where the cubics of an easing meet, as shares of the segment.
std::vector<double> joints_of(const Interpolation& easing) {
  std::vector<double> in;
  if (easing.ease == Ease::Bounce) in = {1 - 2.5 / 2.75, 1 - 2 / 2.75, 1 - 1 / 2.75};
  std::vector<double> joints;
  for (const double each : in) {
    if (easing.side == EaseSide::In) joints.push_back(each);
    if (easing.side == EaseSide::Out) joints.push_back(1 - each);
    if (easing.side == EaseSide::InOut) {
      joints.push_back(each / 2);
      joints.push_back(1 - each / 2);
    }
  }
  if (easing.side == EaseSide::InOut) joints.push_back(0.5);
  return joints;
}

/// Inserts one key, or all that are needed, into keys without a loop, and updates their shape.
template <int D>
class Insertion {
 public:
  Insertion(const Curve<D>& curve, CurveKeys<D> keys, Shape<D> shape, const Track<D>& track,
            double frame)
      : curve_(curve),
        result_(std::move(keys)),
        shape_(std::move(shape)),
        track_(track),
        frame_(frame) {}

  Checked<Curve<D>> insert() {
    if (const auto error =
            frame_ < track_.first() || frame_ > track_.last() ? add_outside() : add_inside()) {
      return tl::unexpected(*error);
    }
    return preserved(std::move(result_), shape_);
  }

 private:
  using Outer = typename Extrapolation<D>::Kind;
  using MaybeError = std::optional<Complaint>;

  std::vector<Key<D>>& keys() { return result_.keys; }

  Key<D>& add(std::size_t index, double frame, Interpolation::Kind next) {
    Key<D> key;
    key.frame = frame;
    key.value = curve_.value(frame);
    key.next.kind = next;
    shape_.keys.insert(shape_.keys.begin() + index, KeySlopes<D>{});
    return *keys().insert(keys().begin() + index, key);
  }

  static bool is_loop(const Extrapolation<D>& side) {
    return side.kind == Outer::Repeat || side.kind == Outer::RepeatOffset ||
           side.kind == Outer::Mirror;
  }

  MaybeError add_outside() {
    const bool is_before = frame_ < track_.first();
    for (Extrapolation<D>* side : {&result_.before, &result_.after}) {
      if (!is_loop(*side) && !(side->kind == Outer::Linear && keys().size() == 1)) continue;
      if (keys().size() > 1) {
        return Complaint{is_before ? 0 : keys().size() - 1,
                         "frame " + number_text(frame_) + " is outside the keys, and " +
                             (side == &result_.before ? "before" : "after") +
                             " shows copies of them; a key there would become part of every copy"};
      }
      *side = {};  // for a single key
    }
    Extrapolation<D>& side = is_before ? result_.before : result_.after;
    const Value<D> slope = *(is_before ? shape_.before : shape_.after);
    const std::size_t old_end = is_before ? 0 : keys().size() - 1;
    // The old end key's outer tangent is not read any more.
    (is_before ? shape_.keys[old_end].in : shape_.keys[old_end].out).reset();
    if (!is_before) keys()[old_end].next = {.kind = Interpolation::Kind::Linear};
    Key<D>& key = add(is_before ? 0 : keys().size(), frame_, Interpolation::Kind::Linear);
    (is_before ? key.in : key.out) = slope_tangent<D>(slope);
    if (side.kind == Outer::Linear) {
      side.kind = Outer::Slope;  // the exact slope, not the rounded one of the new segment
      side.slope = slope;
    }
    return std::nullopt;
  }

  MaybeError add_inside() {
    const std::size_t k = track_.segment_at(frame_);
    const Interpolation next = keys()[k].next;
    switch (next.kind) {
      case Interpolation::Kind::Step:
      case Interpolation::Kind::StepNext:
      case Interpolation::Kind::Linear:
        add(k + 1, frame_, next.kind);
        return std::nullopt;
      case Interpolation::Kind::Bezier:
      case Interpolation::Kind::CubicBezier:
        if (track_.segments[k].kind == Segment<D>::Kind::Bezier) {
          split_general(k);
        } else {
          split_even(k);
        }
        return std::nullopt;
      case Interpolation::Kind::Easing:
        return split_easing(k, next);
    }
    return std::nullopt;
  }

  /// A cubic in time: its parts are again cubics in time, with the slopes of the curve.
  void split_even(std::size_t k) {
    const Segment<D>& segment = track_.segments[k];
    Value<D> start;
    Value<D> end;
    for (int c = 0; c < D; ++c) {
      start[c] = segment.ends[0][c].c1 / segment.length;
      end[c] = -segment.ends[1][c].c1 / segment.length;
    }
    set_even(keys()[k].out, keys()[k].next, start);
    set_even(keys()[k + 1].in, keys()[k].next, end);
    keys()[k].next = {};
    Key<D>& key = add(k + 1, frame_, Interpolation::Kind::Bezier);
    key.in = key.out = slope_tangent<D>(curve_.velocity(frame_));
  }

  /// A tangent with the default length may stay the same: `preserved` keeps its slope.
  static void set_even(Tangent<D>& tangent, const Interpolation& next, const Value<D>& slope) {
    const bool is_read = next.kind == Interpolation::Kind::Bezier;
    if (is_read && tangent.kind != Tangent<D>::Kind::Handle && !tangent.length) return;
    tangent = slope_tangent<D>(slope);
  }

  void split_general(std::size_t k) {
    const Split<D> parts = split(track_, k, frame_);
    const double left = frame_ - keys()[k].frame;
    const double right = keys()[k + 1].frame - frame_;
    if (result_.overshoot == Overshoot::Contain &&
        (is_long(parts.left, left) || is_long(parts.right, right))) {
      // A part may be outside the limits of `contain`, although time runs forwards in it.
      write_corrections(result_, Overshoot::Contain);
      result_.overshoot = Overshoot::Limit;
    }
    keys()[k].next = {};
    keys()[k].out = parts.left.start.as_tangent(true);
    keys()[k + 1].in = parts.right.end.as_tangent(false);
    shape_.keys[k].out.reset();
    shape_.keys[k + 1].in.reset();
    Key<D>& key = add(k + 1, frame_, Interpolation::Kind::Bezier);
    key.in = parts.left.end.as_tangent(false);
    key.out = parts.right.start.as_tangent(true);
  }

  static bool is_long(const Handles<D>& handles, double span) {
    return std::max(handles.start.frames, handles.end.frames) > span;
  }

  MaybeError split_easing(std::size_t k, const Interpolation& easing) {
    const Segment<D>& segment = track_.segments[k];
    bool is_level = true;
    for (int c = 0; c < D; ++c) is_level = is_level && segment.ends[0][c].c1 == 0;
    if (is_level) {
      keys()[k].next = {.kind = Interpolation::Kind::Linear};
      add(k + 1, frame_, Interpolation::Kind::Linear);
      return std::nullopt;
    }
    if (!is_row_of_cubics(easing.ease)) {
      return Complaint{k, "the segment from frame " + number_text(segment.start) +
                              " has the easing " + name_of(easing) +
                              ", which a key cannot divide: only quad, cubic, back and bounce "
                              "consist of cubics; bake it first"};
    }
    std::vector<double> frames = {segment.start, frame_, segment.end};
    for (const double joint : joints_of(easing)) {
      frames.push_back(
          std::clamp(segment.start + joint * segment.length, segment.start, segment.end));
    }
    std::sort(frames.begin(), frames.end());
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());

    keys()[k].next = {};
    for (std::size_t i = 1; i + 1 < frames.size(); ++i) {
      add(k + i, frames[i], Interpolation::Kind::Bezier);
    }
    for (std::size_t i = 0; i + 1 < frames.size(); ++i) {
      shape_cubic(keys()[k + i], keys()[k + i + 1]);
    }
    return std::nullopt;
  }

  /// Gives the cubic between two keys its slopes at both ends. The slope of a cubic is a parabola,
  /// here computed from three places inside: at a joint itself an easing may have two slopes.
  void shape_cubic(Key<D>& left, Key<D>& right) const {
    const double span = right.frame - left.frame;
    const Value<D> first = curve_.velocity(left.frame + span / 4);
    const Value<D> middle = curve_.velocity(left.frame + span / 2);
    const Value<D> last = curve_.velocity(right.frame - span / 4);
    Value<D> start;
    Value<D> end;
    for (int c = 0; c < D; ++c) {
      start[c] = 3 * (first[c] - middle[c]) + last[c];
      end[c] = first[c] + 3 * (last[c] - middle[c]);
    }
    left.out = slope_tangent<D>(start);
    right.in = slope_tangent<D>(end);
  }

  const Curve<D>& curve_;
  CurveKeys<D> result_;
  Shape<D> shape_;
  const Track<D>& track_;
  double frame_;
};

}  // namespace

}  // namespace timeline

template <int D>
Checked<Curve<D>> insert_key(const Curve<D>& curve, double frame) {
  using namespace timeline;
  if (!std::isfinite(frame)) {
    return tl::unexpected(
        Complaint{0, "frame of the new key is " + number_text(frame) + "; it must be finite"});
  }
  auto keys = without_loop(curve.keys());
  if (!keys) return tl::unexpected(keys.error());
  const auto compiled = compile(*keys);
  if (!compiled) return tl::unexpected(compiled.error());
  const Track<D>& track = compiled->curve.track;
  if (std::binary_search(track.frames.begin(), track.frames.end(), frame)) return curve;
  auto shape = shape_of(*keys);
  if (!shape) return tl::unexpected(shape.error());
  return Insertion<D>(curve, *std::move(keys), *std::move(shape), track, frame).insert();
}

template Checked<Curve<1>> insert_key(const Curve<1>&, double);
template Checked<Curve<3>> insert_key(const Curve<3>&, double);

}  // namespace pliant
