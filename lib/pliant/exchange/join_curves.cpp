#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "pliant/exchange/convert.hpp"
#include "pliant/exchange/curve_names.hpp"

namespace pliant {
namespace exchange {
namespace {

using Components = std::array<const CurveKeys<1>*, 3>;
using Kind3 = Tangent<3>::Kind;

// Handles in single precision differ by less than this share of their segment.
constexpr double same_length = 1e-6;

bool is_near(double a, double b, double segment) {
  return std::fabs(a - b) <= same_length * segment;
}

bool has_same_reach(const Tangent<1>& a, const Tangent<1>& b, double segment) {
  if (a.kind != b.kind) return false;
  if (a.kind == Tangent<1>::Kind::Handle) return is_near(a.handle_frames, b.handle_frames, segment);
  return a.length.has_value() == b.length.has_value() &&
         (!a.length || is_near(*a.length, *b.length, segment));
}

bool has_same_side(const Extrapolation<1>& a, const Extrapolation<1>& b) {
  return a.kind == b.kind && a.count == b.count;
}

bool has_same_loop(const CurveKeys<1>& a, const CurveKeys<1>& b) {
  if (a.loop.has_value() != b.loop.has_value()) return false;
  return !a.loop || (a.loop->from == b.loop->from && a.loop->to == b.loop->to &&
                     a.loop->before == b.loop->before && a.loop->after == b.loop->after);
}

/// Whether both have keys that a vector's keys can be.
bool is_alike(const CurveKeys<1>& a, const CurveKeys<1>& b) {
  if (a.keys.size() != b.keys.size() || a.overshoot != b.overshoot ||
      !has_same_side(a.before, b.before) || !has_same_side(a.after, b.after) ||
      !has_same_loop(a, b))
    return false;
  for (std::size_t k = 0; k < a.keys.size(); ++k) {
    const Key<1>& one = a.keys[k];
    const Key<1>& other = b.keys[k];
    const double before = k > 0 ? one.frame - a.keys[k - 1].frame : 1;
    const double after = k + 1 < a.keys.size() ? a.keys[k + 1].frame - one.frame : 1;
    if (one.frame != other.frame || one.next != other.next ||
        !has_same_reach(one.in, other.in, before) || !has_same_reach(one.out, other.out, after))
      return false;
  }
  return true;
}

/// The seam of a repetition is smooth if the ends are level: of one component, not of another.
bool has_same_seam(const Components& components) {
  const auto closes = [](const CurveKeys<1>& keys) {
    return keys.keys.front().value == keys.keys.back().value;
  };
  const CurveKeys<1>* first = nullptr;
  for (const CurveKeys<1>* each : components) {
    if (!each) continue;
    const bool repeats = each->before.kind == Extrapolation<1>::Kind::Repeat ||
                         each->after.kind == Extrapolation<1>::Kind::Repeat;
    if (first && repeats && closes(*first) != closes(*each)) return false;
    first = each;
  }
  return true;
}

CurveKeys<3> joined_alike(const Components& components, const Value<3>& constant) {
  const CurveKeys<1>& first = **std::find_if(components.begin(), components.end(),
                                             [](const auto* each) { return each != nullptr; });
  CurveKeys<3> result;
  result.overshoot = first.overshoot;
  const auto side = [&](Extrapolation<1> CurveKeys<1>::*which) {
    Extrapolation<3> joined;
    joined.kind = static_cast<Extrapolation<3>::Kind>((first.*which).kind);
    joined.count = (first.*which).count;
    for (std::size_t c = 0; c < 3; ++c)
      if (components[c]) joined.slope[c] = ((*components[c]).*which).slope[0];
    return joined;
  };
  result.before = side(&CurveKeys<1>::before);
  result.after = side(&CurveKeys<1>::after);
  if (first.loop) {
    result.loop = Loop<3>{.from = first.loop->from,
                          .to = first.loop->to,
                          .before = first.loop->before,
                          .after = first.loop->after};
    for (std::size_t c = 0; c < 3; ++c)
      if (components[c]) result.loop->offset[c] = components[c]->loop->offset[0];
  }
  for (std::size_t k = 0; k < first.keys.size(); ++k) {
    const Key<1>& model = first.keys[k];
    Key<3> key{.frame = model.frame, .value = constant, .next = model.next};
    const auto tangent = [&](const Tangent<1> Key<1>::*which) {
      Tangent<3> joined{.kind = static_cast<Kind3>((model.*which).kind),
                        .length = (model.*which).length,
                        .handle_frames = (model.*which).handle_frames};
      for (std::size_t c = 0; c < 3; ++c) {
        if (!components[c]) continue;
        const Tangent<1>& own = components[c]->keys[k].*which;
        joined.slope[c] = own.slope[0];
        joined.handle_value[c] = own.handle_value[0];
      }
      return joined;
    };
    key.in = tangent(&Key<1>::in);
    key.out = tangent(&Key<1>::out);
    Value<3> left = constant;
    bool has_left = false;
    for (std::size_t c = 0; c < 3; ++c) {
      if (!components[c]) continue;
      const Key<1>& own = components[c]->keys[k];
      key.value[c] = own.value[0];
      left[c] = own.left ? (*own.left)[0] : own.value[0];
      has_left = has_left || own.left.has_value();
    }
    if (has_left) key.left = left;
    result.keys.push_back(key);
  }
  return result;
}

bool has_copies(const Beyond& side) { return side.kind != Beyond::Kind::Line; }

bool is_level(const Segments& segments) {
  const double value = segments.values.front();
  const bool are_level =
      std::all_of(segments.segments.begin(), segments.segments.end(), [&](const Segment& segment) {
        return segment.from == value && segment.to == value && segment.out.value == 0 &&
               segment.in.value == 0 && segment.kind != Segment::Kind::Easing;
      });
  const auto stays = [&](const Beyond& side) {
    return side.kind != Beyond::Kind::Line || (side.slope == 0 && side.anchor == value);
  };
  return are_level && stays(segments.before) && stays(segments.after);
}

/// Joins curves whose keys differ: cubics in time, which can be cut anywhere.
class Joiner {
 public:
  Joiner(const Components& components, const Value<3>& constant, double tolerance,
         const StopRequest& should_stop)
      : components_(components),
        constant_(constant),
        tolerance_(tolerance),
        should_stop_(should_stop) {}

  Result<JoinedCurve> join() {
    for (std::size_t c = 0; c < 3; ++c) {
      if (!components_[c]) continue;
      if (auto converted = convert_component(c); !converted) return fail(converted.error());
    }
    std::sort(frames_.begin(), frames_.end());
    frames_.erase(std::unique(frames_.begin(), frames_.end()), frames_.end());
    for (const bool is_before : {true, false}) {
      if (auto set = set_side(is_before); !set) return fail(set.error());
    }
    for (const double frame : frames_) result_.keys.keys.push_back({.frame = frame});
    for (std::size_t k = 0; k < frames_.size(); ++k) {
      if (is_stopped(should_stop_, k)) return interrupted();
      set_key(k);
    }
    std::size_t most = 0;
    for (const auto* each : components_)
      if (each) most = std::max(most, each->keys.size());
    result_.losses.insert(result_.losses.begin(),
                          fmt::format("its components have keys that differ: they became {} keys "
                                      "together, of up to {}",
                                      frames_.size(), most));
    return std::move(result_);
  }

 private:
  Result<void> convert_component(std::size_t c) {
    const auto curve = Curve<1>::make(*components_[c], should_stop_);
    if (!curve) return fail(error_of(curve.error(), ""));
    const auto& keys = curve->keys().keys;
    const ValueRange<1> range = curve->range(keys.front().frame, keys.back().frame);
    const Abilities abilities{
        .has_left_values = true, .has_long_arms = false, .has_counted_copies = true};
    auto converted =
        convert(segments_of(*curve), abilities, tolerance_ * (range.high[0] - range.low[0]),
                {keys.front().frame, keys.back().frame}, should_stop_);
    if (!converted) return fail(converted.error());
    for (Loss& loss : converted->losses)
      result_.losses.push_back(fmt::format(".{}: {}", "xyz"[c], loss.message));
    frames_.insert(frames_.end(), converted->segments.frames.begin(),
                   converted->segments.frames.end());
    segments_[c] = std::move(converted->segments);
    return {};
  }

  /// Copies must be of the same span; level components show the same with any.
  Result<void> set_side(bool is_before) {
    Extrapolation<3>& side = is_before ? result_.keys.before : result_.keys.after;
    const Segments* model = nullptr;
    for (const auto& segments : segments_) {
      if (!segments || is_level(*segments)) continue;
      const Beyond& own = is_before ? segments->before : segments->after;
      if (!model) {
        model = &*segments;
        continue;
      }
      const Beyond& other = is_before ? model->before : model->after;
      const bool are_copies = has_copies(own) || has_copies(other);
      if (!are_copies) continue;
      const bool is_same = (own.kind == other.kind || (repeats(own) && repeats(other))) &&
                           own.count == other.count &&
                           segments->frames.front() == model->frames.front() &&
                           segments->frames.back() == model->frames.back();
      if (!is_same) {
        return invalid(fmt::format(
            "its components have different copies {} the keys, which one vector cannot have; give "
            "them the same, or keys instead",
            is_before ? "before" : "after"));
      }
      if (own.kind != other.kind && own.kind == Beyond::Kind::RepeatOffset) model = &*segments;
    }
    if (!model) return {};
    const Beyond& own = is_before ? model->before : model->after;
    const bool covers =
        model->frames.front() == frames_.front() && model->frames.back() == frames_.back();
    if (has_copies(own) && !covers) {
      return invalid(fmt::format("its components have keys beyond those that have copies {} them",
                                 is_before ? "before" : "after"));
    }
    using Side = Extrapolation<3>::Kind;
    constexpr Side kinds[] = {Side::Slope, Side::Repeat, Side::RepeatOffset, Side::Mirror};
    side.kind = kinds[static_cast<int>(own.kind)];
    if (has_copies(own)) {
      if (std::isfinite(own.count)) side.count = own.count;
      return {};
    }
    bool is_hold = true;
    for (std::size_t c = 0; c < 3; ++c) {
      if (!segments_[c]) continue;
      const Beyond& line = is_before ? segments_[c]->before : segments_[c]->after;
      if (has_copies(line)) continue;  // level
      side.slope[c] = line.slope;
      is_hold = is_hold && line.slope == 0;
    }
    if (is_hold) side.kind = Side::Hold;
    return {};
  }

  /// Repetition that is the same with an offset: of nothing.
  static bool repeats(const Beyond& side) {
    return side.kind == Beyond::Kind::RepeatOffset ||
           (side.kind == Beyond::Kind::Repeat && side.offset == 0);
  }

  /// The part of a component between two neighbouring frames.
  Segment part(std::size_t c, std::size_t k) {
    const double start = frames_[k], end = frames_[k + 1];
    if (!segments_[c]) return level_part(start, end, constant_[c], constant_[c]);
    const Segments& own = *segments_[c];
    if (start >= own.frames.back()) {
      const auto at = [&](double frame) {
        return own.values.back() + slope_of(own.after) * (frame - own.frames.back());
      };
      return level_part(start, end, at(start), at(end));
    }
    if (end <= own.frames.front()) {
      const double anchor = has_copies(own.before) ? own.values.front() : own.before.anchor;
      const auto at = [&](double frame) {
        return anchor + slope_of(own.before) * (frame - own.frames.front());
      };
      return level_part(start, end, at(start), at(end));
    }
    std::size_t& next = next_[c];
    while (own.segments[next].end <= start) ++next;
    Segment segment = own.segments[next];
    if (segment.start < start) segment = cut(segment, start).right;
    if (end < segment.end) segment = cut(segment, end).left;
    return segment;
  }

  static double slope_of(const Beyond& side) { return has_copies(side) ? 0 : side.slope; }

  static Segment level_part(double start, double end, double from, double to) {
    return {.start = start, .end = end, .from = from, .to = to};
  }

  /// The value exactly at a frame, `after`: the part that begins there.
  double value_at(std::size_t c, std::size_t k, const Segment* after) const {
    if (!segments_[c]) return constant_[c];
    const Segments& own = *segments_[c];
    const auto found = std::lower_bound(own.frames.begin(), own.frames.end(), frames_[k]);
    if (found != own.frames.end() && *found == frames_[k])
      return own.values[static_cast<std::size_t>(found - own.frames.begin())];
    if (after) return after->from;
    return own.values.back() + slope_of(own.after) * (frames_[k] - own.frames.back());
  }

  void set_key(std::size_t k) {
    Key<3>& key = result_.keys.keys[k];
    const bool is_last = k + 1 == frames_.size();
    std::array<Segment, 3> parts;
    for (std::size_t c = 0; c < 3; ++c) {
      if (!is_last) parts[c] = part(c, k);
      key.value[c] = value_at(c, k, is_last ? nullptr : &parts[c]);
    }
    if (k > 0 && arrival_ != key.value &&
        result_.keys.keys[k - 1].next.kind != Interpolation::Kind::Step)
      key.left = arrival_;
    // Before the first key the curve starts from its left value.
    if (k == 0) set_first_left(key);
    if (is_last) return;
    const auto all = [&](Segment::Kind kind, Segment::Kind or_kind) {
      return std::all_of(parts.begin(), parts.end(), [&](const Segment& segment) {
        return segment.kind == kind || segment.kind == or_kind || is_flat(segment);
      });
    };
    if (all(Segment::Kind::Constant, Segment::Kind::Constant)) {
      key.next.kind = Interpolation::Kind::Step;
    } else if (all(Segment::Kind::Line, Segment::Kind::Constant)) {
      key.next.kind = Interpolation::Kind::Linear;
    } else {
      Key<3>& next = result_.keys.keys[k + 1];
      key.out.kind = next.in.kind = Kind3::Slope;
      for (std::size_t c = 0; c < 3; ++c) {
        key.out.slope[c] = slope_at_start(parts[c]);
        next.in.slope[c] = slope_at_end(parts[c]);
      }
    }
    for (std::size_t c = 0; c < 3; ++c) arrival_[c] = parts[c].to;
  }

  static bool is_flat(const Segment& segment) {
    return segment.kind == Segment::Kind::Line && segment.from == segment.to;
  }

  void set_first_left(Key<3>& key) const {
    Value<3> left = key.value;
    for (std::size_t c = 0; c < 3; ++c) {
      if (!segments_[c] || segments_[c]->frames.front() != key.frame) continue;
      const Beyond& side = segments_[c]->before;
      if (!has_copies(side)) left[c] = side.anchor;
    }
    if (left != key.value) key.left = left;
  }

  const Components& components_;
  const Value<3>& constant_;
  double tolerance_;
  const StopRequest& should_stop_;
  std::array<std::optional<Segments>, 3> segments_;
  std::array<std::size_t, 3> next_{};
  std::vector<double> frames_;
  Value<3> arrival_{};
  JoinedCurve result_;
};

}  // namespace
}  // namespace exchange

Result<JoinedCurve> join_curves(const std::array<const CurveKeys<1>*, 3>& components,
                                const Value<3>& constant, double tolerance,
                                const StopRequest& should_stop) {
  using namespace exchange;
  const CurveKeys<1>* first = nullptr;
  bool are_alike = has_same_seam(components);
  for (const CurveKeys<1>* each : components) {
    if (!each) continue;
    if (!first)
      first = each;
    else
      are_alike = are_alike && is_alike(*first, *each);
  }
  if (!first) return invalid("a vector needs a curve of at least one component");
  if (are_alike) {
    JoinedCurve result{joined_alike(components, constant), {}};
    if (const auto made = Curve<3>::make(result.keys, should_stop); !made)
      return fail(error_of(made.error(), ""));
    return result;
  }
  auto joined = Joiner(components, constant, tolerance, should_stop).join();
  if (!joined) return fail(joined.error());
  if (const auto made = Curve<3>::make(joined->keys, should_stop); !made)
    return fail(error_of(made.error(), ""));
  return joined;
}

CurveKeys<1> component_of(const CurveKeys<3>& keys, int component) {
  const auto c = static_cast<std::size_t>(component);
  CurveKeys<1> result;
  result.overshoot = keys.overshoot;
  const auto side = [&](const Extrapolation<3>& own) {
    return Extrapolation<1>{.kind = static_cast<Extrapolation<1>::Kind>(own.kind),
                            .slope = {own.slope[c]},
                            .count = own.count};
  };
  result.before = side(keys.before);
  result.after = side(keys.after);
  if (keys.loop) {
    result.loop = Loop<1>{.from = keys.loop->from,
                          .to = keys.loop->to,
                          .before = keys.loop->before,
                          .after = keys.loop->after,
                          .offset = {keys.loop->offset[c]}};
  }
  const auto tangent = [&](const Tangent<3>& own) {
    return Tangent<1>{.kind = static_cast<Tangent<1>::Kind>(own.kind),
                      .slope = {own.slope[c]},
                      .length = own.length,
                      .handle_frames = own.handle_frames,
                      .handle_value = {own.handle_value[c]}};
  };
  for (const Key<3>& own : keys.keys) {
    Key<1> key{.frame = own.frame, .value = {own.value[c]}, .next = own.next};
    key.in = tangent(own.in);
    key.out = tangent(own.out);
    if (own.left) key.left = Value<1>{(*own.left)[c]};
    result.keys.push_back(key);
  }
  return result;
}

}  // namespace pliant
