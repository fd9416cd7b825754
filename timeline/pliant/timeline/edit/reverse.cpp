#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pliant/timeline/edit/edit.hpp"
#include "pliant/timeline/edit/preserve.hpp"
#include "pliant/timeline/key_polyline.hpp"
#include "pliant/timeline/loop.hpp"
#include "pliant/timeline/number_text.hpp"

namespace pliant {

namespace timeline {

namespace {

template <int D>
Value<D> negative(Value<D> value) {
  for (double& each : value) each = 0 - each;
  return value;
}

Interpolation reversed(Interpolation next) {
  using Kind = Interpolation::Kind;
  if (next.kind == Kind::Step) {
    next.kind = Kind::StepNext;
  } else if (next.kind == Kind::StepNext) {
    next.kind = Kind::Step;
  } else if (next.kind == Kind::CubicBezier) {
    const auto [x1, y1, x2, y2] = next.control;
    next.control = {1 - x2, 1 - y2, 1 - x1, 1 - y1};
  } else if (next.kind == Kind::Easing && next.side != EaseSide::InOut) {
    next.side = next.side == EaseSide::In ? EaseSide::Out : EaseSide::In;  // eq. 14
  }
  return next;
}

template <int D>
Tangent<D> reversed(Tangent<D> tangent) {
  tangent.slope = negative<D>(tangent.slope);
  tangent.handle_frames = 0 - tangent.handle_frames;
  return tangent;
}

template <int D>
Extrapolation<D> reversed(Extrapolation<D> outside) {
  outside.slope = negative<D>(outside.slope);
  return outside;
}

/// How the two sides of a curve use an end key that jumps.
template <int D>
class EndKeys {
 public:
  explicit EndKeys(const CurveKeys<D>& keys) : keys_(keys) {}

  /// Whether `left` of the first key is never visible: there is a loop before it, and no side adds
  /// offsets.
  bool hides_first_left() const {
    return has_copies(keys_.before) && keys_.before.kind != Kind::RepeatOffset &&
           keys_.after.kind != Kind::RepeatOffset;
  }

  /// The end key whose value is constant after the last copy; the reversed key has another value.
  std::optional<std::size_t> held_jump() const {
    const bool first = ends_with_first(keys_.before, true) || ends_with_first(keys_.after, false);
    const bool last = ends_with_last(keys_.before, true) || ends_with_last(keys_.after, false);
    if (first && jumps(0) && !hides_first_left()) return 0;
    if (last && jumps(keys_.keys.size() - 1)) return keys_.keys.size() - 1;
    return std::nullopt;
  }

 private:
  using Kind = typename Extrapolation<D>::Kind;

  bool has_copies(const Extrapolation<D>& side) const {
    return keys_.keys.size() > 1 && (side.kind == Kind::Repeat || side.kind == Kind::RepeatOffset ||
                                     side.kind == Kind::Mirror);
  }
  bool ends_with_first(const Extrapolation<D>& side, bool is_before) const {
    return is_counted(side) && is_before != is_turned(side);
  }
  bool ends_with_last(const Extrapolation<D>& side, bool is_before) const {
    return is_counted(side) && is_before == is_turned(side);
  }
  bool is_counted(const Extrapolation<D>& side) const {
    return has_copies(side) && side.count.has_value();
  }
  static bool is_turned(const Extrapolation<D>& side) {
    return side.kind == Kind::Mirror && std::fmod(*side.count, 2) == 1;
  }
  bool jumps(std::size_t key) const {
    return has_jump(keys_.keys, key) && *keys_.keys[key].left != keys_.keys[key].value;
  }

  const CurveKeys<D>& keys_;
};

/// Keys without a loop, reversed.
template <int D>
CurveKeys<D> reversed(const CurveKeys<D>& keys, double pivot) {
  const bool hides_first_left = EndKeys<D>(keys).hides_first_left();
  CurveKeys<D> result = keys;
  result.keys.clear();
  for (std::size_t k = keys.keys.size(); k-- > 0;) {
    const Key<D>& key = keys.keys[k];
    Key<D> back = key;
    back.frame = 2 * pivot - key.frame;
    back.left.reset();
    if (has_jump(keys.keys, k) && !(k == 0 && hides_first_left)) {
      back.left = key.value;
      back.value = *key.left;
    }
    back.in = reversed<D>(key.out);
    back.out = reversed<D>(key.in);
    back.next = reversed(keys.keys[k > 0 ? k - 1 : keys.keys.size() - 1].next);
    result.keys.push_back(back);
  }
  result.before = reversed(keys.after);
  result.after = reversed(keys.before);
  return result;
}

template <int D>
Shape<D> reversed(const Shape<D>& shape) {
  Shape<D> result;
  for (std::size_t k = shape.keys.size(); k-- > 0;) {
    KeySlopes<D> slopes{shape.keys[k].out, shape.keys[k].in};
    if (slopes.in) slopes.in = negative<D>(*slopes.in);
    if (slopes.out) slopes.out = negative<D>(*slopes.out);
    result.keys.push_back(slopes);
  }
  result.before = negative<D>(*shape.after);
  result.after = negative<D>(*shape.before);
  return result;
}

/// The reversed keys of an author's loop, from the reversal of all keys that it writes out: the
/// copy that ended in the keys of the loop, and the keys outside of all copies.
template <int D>
CurveKeys<D> with_loop(const CurveKeys<D>& author, const CurveKeys<D>& reversed_keys) {
  const Loop<D>& loop = *author.loop;
  std::size_t first = 0;  // first key of the loop
  while (author.keys[first].frame != loop.from) ++first;
  std::size_t count = 0;  // number of keys in one copy
  while (first + count < author.keys.size() && author.keys[first + count].frame < loop.to) ++count;
  const double start = loop.from - loop.before * (loop.to - loop.from);
  std::size_t ahead = 0;  // written keys before the first copy
  while (author.keys[ahead].frame < start) ++ahead;

  const std::vector<Key<D>>& keys = reversed_keys.keys;
  const std::size_t copies = 1u + loop.before + loop.after;
  const auto turned = [&](std::size_t index) { return keys.size() - 1 - index; };
  const std::size_t from = turned(ahead + (loop.before + 1u) * count);
  const auto begin = keys.begin();

  CurveKeys<D> result = reversed_keys;
  result.keys.assign(begin, begin + turned(ahead + copies * count));
  result.keys.insert(result.keys.end(), begin + from, begin + from + count);
  result.keys.insert(result.keys.end(), begin + turned(ahead) + 1, keys.end());
  Loop<D> back;
  back.from = keys[from].frame;
  back.to = keys[from + count].frame;
  back.before = loop.after;
  back.after = loop.before;
  back.offset = negative<D>(loop.offset);
  result.loop = back;
  return result;
}

}  // namespace

}  // namespace timeline

template <int D>
Checked<Curve<D>> reverse(const Curve<D>& curve, double pivot) {
  using namespace timeline;
  if (!std::isfinite(pivot)) {
    return tl::unexpected(
        Complaint{0, "pivot is " + number_text(pivot) + "; it must be a finite frame"});
  }
  auto written = written_out(curve.keys());
  if (!written) return tl::unexpected(written.error());
  CurveKeys<D> before = curve.keys();
  if (!written->keys.empty()) before.keys = written->keys;
  before.loop.reset();
  if (const auto key = EndKeys<D>(before).held_jump()) {
    return tl::unexpected(
        Complaint{written->origin_of(*key),
                  "the key at frame " + number_text(before.keys[*key].frame) +
                      " jumps, and a side that repeats keeps its value after the last "
                      "copy, which cannot be reversed; remove the count or the jump"});
  }
  const auto shape_before = shape_of(before);
  if (!shape_before) return tl::unexpected(shape_before.error());
  // Maya's rule distinguishes start and end; the others are symmetric.
  if (before.overshoot == Overshoot::KeepStart) write_corrections(before, Overshoot::KeepStart);
  CurveKeys<D> keys = reversed(before, pivot);
  const Shape<D> shape = reversed(*shape_before);
  Slack slack = rounding_of(before);
  slack.frame = std::max(slack.frame, rounding_of(keys).frame);
  if (curve.keys().loop && (curve.keys().loop->before > 0 || curve.keys().loop->after > 0)) {
    CurveKeys<D> author = with_loop(curve.keys(), keys);
    if (stands_for(author, keys, shape, slack)) return Curve<D>::make(std::move(author));
  }
  if (keys.overshoot == Overshoot::Error) write_corrections(keys, Overshoot::Limit);
  return preserved(std::move(keys), shape, slack);
}

template Checked<Curve<1>> reverse(const Curve<1>&, double);
template Checked<Curve<3>> reverse(const Curve<3>&, double);

}  // namespace pliant
