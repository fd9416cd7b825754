#include "pliant/timeline/edit/edit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/timeline/curve_numbers.hpp"
#include "pliant/timeline/edit/bake_keys.hpp"
#include "pliant/timeline/edit/simplify.hpp"
#include "support/catch.hpp"
#include "support/sanitized.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

double size_of(const Curve<1>& curve) {
  double size = 0;
  for (const Key<1>& key : curve.keys().keys) {
    size = std::max(size, std::fabs(key.value[0]));
    if (key.left) size = std::max(size, std::fabs((*key.left)[0]));
  }
  const auto range = curve.range(curve.keys().keys.front().frame, curve.keys().keys.back().frame);
  return std::max({size, std::fabs(range.low[0]), std::fabs(range.high[0])});
}

/// How far a value is outside the range of a curve within `reach` frames of a frame: so rounding
/// errors of time do not count, however steep the curve is.
double miss(double value, const Curve<1>& curve, double frame, double reach) {
  const auto range = curve.range(frame - reach, frame + reach);
  return std::max({0.0, range.low[0] - value, value - range.high[0]});
}

/// A random curve, sometimes with an inner loop.
Curve<1> some_curve(Whim& whim, int most) {
  for (;;) {
    CurveKeys<1> keys = whim.keys(most);
    if (whim.once_in(5)) {
      const auto& some = keys.keys[whim.upto(static_cast<int>(keys.keys.size()) - 1)];
      const auto& other = keys.keys[whim.upto(static_cast<int>(keys.keys.size()) - 1)];
      const double to = other.frame > some.frame ? other.frame : some.frame + whim.size(-1, 1);
      keys.loop = Loop<1>{some.frame, to, whim.upto(2), whim.upto(2), {whim.between(-3, 3)}};
    }
    const auto curve = Curve<1>::make(keys);  // copies of a loop may collide
    if (curve) return *curve;
  }
}

double some_frame(Whim& whim, const Curve<1>& curve) {
  const double first = curve.keys().keys.front().frame;
  const double last = curve.keys().keys.back().frame;
  return whim.between(first - 10, last + 10);
}

double shortest_span(const Curve<1>& curve) {
  const auto& keys = curve.keys().keys;
  double shortest = 1;
  for (std::size_t k = 1; k < keys.size(); ++k) {
    shortest = std::min(shortest, keys[k].frame - keys[k - 1].frame);
  }
  return shortest;
}

std::vector<double> key_frames(const Curve<1>& curve) {
  std::vector<double> frames;
  for (const Key<1>& key : curve.keys().keys) frames.push_back(key.frame);
  return frames;
}

/// Whether slopes agree, unless they are so steep that the rounding of time dominates.
bool slopes_agree(double a, double b, double size) {
  if (!(std::fabs(a) < 100 * size) || !(std::fabs(b) < 100 * size)) return true;
  return std::fabs(a - b) <= 1e-7 * (1 + size);
}

TEST_CASE("a key put into a curve leaves it as it was", "[timeline][edit]") {
  Whim whim(1);
  int inserted = 0;
  int refused = 0;
  for (int round = 0; round < rounds(20000); ++round) {
    const Curve<1> curve = some_curve(whim, 6);
    double frame = some_frame(whim, curve);
    if (whim.once_in(10)) frame = curve.keys().keys.front().frame + whim.size(-12, -6);
    const auto edited = insert_key(curve, frame);
    CAPTURE(round, frame);
    if (!edited) {
      const std::string& message = edited.error().message;
      INFO(message);
      const bool is_documented = message.find("shows copies") != std::string::npos ||
                                 message.find("which a key cannot divide") != std::string::npos;
      REQUIRE(is_documented);
      ++refused;
      continue;
    }
    ++inserted;
    const double size = size_of(curve);
    bool is_there = false;
    for (const Key<1>& key : edited->keys().keys) is_there = is_there || key.frame == frame;
    if (!is_there) REQUIRE(edited->keys() == curve.keys());
    double worst = 0;
    double worst_frame = 0;
    const auto check = [&](double t, double error) {
      const double share = error / (size + std::fabs(at(curve, t)));
      if (share > worst) worst_frame = t;
      worst = std::max(worst, share);
    };
    for (int i = 0; i < 12; ++i) {
      const double t = i < 8 ? some_frame(whim, curve) : frame + whim.between(-0.1, 0.1);
      const double reach = 8 * epsilon * (std::fabs(t) + 40);
      check(t, miss(at(*edited, t), curve, t, reach));
      check(t, miss(edited->left_value(t)[0], curve, t, reach));
    }
    for (const double t : key_frames(curve)) {
      check(t, std::fabs(at(*edited, t) - at(curve, t)));
      check(t, std::fabs(edited->left_value(t)[0] - curve.left_value(t)[0]));
    }
    CAPTURE(worst_frame, at(curve, worst_frame), at(*edited, worst_frame));
    if (worst > 1e-12) REQUIRE(worst <= 1e-12);
  }
  CHECK(inserted > rounds(10000));
  CHECK(refused > rounds(1000));
}

TEST_CASE("a key put into a curve leaves its velocities", "[timeline][edit]") {
  Whim whim(2);
  for (int round = 0; round < rounds(10000); ++round) {
    const Curve<1> curve = some_curve(whim, 6);
    const double frame = some_frame(whim, curve);
    const auto edited = insert_key(curve, frame);
    if (!edited) continue;
    // A key's value is rounded, and so is the slope to a nearby key.
    double nearest = 1;
    for (const double t : key_frames(curve)) nearest = std::min(nearest, std::fabs(t - frame));
    if (nearest < 1e-4) continue;
    const double size = size_of(curve);
    bool agrees = true;
    double worst_frame = 0;
    const auto check = [&](double t, double a, double b) {
      if (slopes_agree(a, b, size)) return;
      agrees = false;
      worst_frame = t;
    };
    std::vector<double> frames = key_frames(curve);
    frames.push_back(frame);
    for (int i = 0; i < 6; ++i) frames.push_back(some_frame(whim, curve));
    for (const double t : frames) {
      const double step = 1e-7 * (1 + std::fabs(t));
      check(t, edited->velocity(t + step)[0], curve.velocity(t + step)[0]);
      check(t, edited->left_velocity(t - step)[0], curve.left_velocity(t - step)[0]);
      // At a key without a handle, which the handle of the other key reaches, the slope is a
      // quotient of rounding errors, both before and after; then it is not the slope beside the
      // key.
      const auto settles = [&](const Curve<1>& any) {
        const double right = any.velocity(t)[0] - any.velocity(t + step)[0];
        const double left = any.left_velocity(t)[0] - any.left_velocity(t - step)[0];
        return std::max(std::fabs(right), std::fabs(left)) < 1e-5 * size;
      };
      if (!settles(curve) || !settles(*edited)) continue;
      check(t, edited->velocity(t)[0], curve.velocity(t)[0]);
      check(t, edited->left_velocity(t)[0], curve.left_velocity(t)[0]);
    }
    CAPTURE(round, frame, worst_frame, curve.velocity(worst_frame)[0],
            edited->velocity(worst_frame)[0]);
    if (!agrees) REQUIRE(agrees);
  }
}

/// g(map(t)) = rise(f(t)) for an edit that moves time by `map` and values by `rise`.
template <class Edit, class Map, class Rise>
void check_equivariance(std::uint64_t seed, bool is_reversed, double growth, const Edit& edit,
                        const Map& map, const Rise& rise) {
  Whim whim(seed);
  int edited_curves = 0;
  for (int round = 0; round < rounds(10000); ++round) {
    const Curve<1> curve = some_curve(whim, 6);
    const auto edited = edit(curve);
    CAPTURE(round);
    if (!edited) {
      const std::string& message = edited.error().message;
      INFO(message);
      REQUIRE(message.find("jumps, and a side that repeats keeps its value") != std::string::npos);
      continue;
    }
    ++edited_curves;
    const double size = size_of(curve);
    const double first = curve.keys().keys.front().frame;
    const double last = curve.keys().keys.back().frame;
    double worst = 0;
    double worst_frame = 0;
    const auto check = [&](double t, double error) {
      const double share = error / (size + size_of(*edited) + std::fabs(at(curve, t)));
      if (share > worst) worst_frame = t;
      worst = std::max(worst, share);
    };
    for (int i = 0; i < 10; ++i) {
      const double t = some_frame(whim, curve);
      // The rounding error of a frame, before and after the edit; a copy of the keys accumulates
      // the rounding errors of their span.
      const double copies = std::fabs(t - first) / (last - first + 1e-3);
      const double reach =
          16 * epsilon * (std::fabs(t) + 100 + std::fabs(map(t)) / growth) * (1 + copies);
      const auto range = curve.range(t - reach, t + reach);
      const double low = std::min(rise(range.low[0]), rise(range.high[0]));
      const double high = std::max(rise(range.low[0]), rise(range.high[0]));
      const double value = at(*edited, map(t));
      check(t, std::max({0.0, low - value, value - high}));
    }
    for (const Key<1>& key : curve.keys().keys) {
      // At a key the limits are compared individually; copies of an inner loop round their frames
      // again.
      if (is_reversed || curve.keys().loop) break;
      const double t = key.frame;
      check(t, std::fabs(at(*edited, map(t)) - rise(at(curve, t))));
      check(t, std::fabs(edited->left_value(map(t))[0] - rise(curve.left_value(t)[0])));
    }
    CAPTURE(worst_frame, at(curve, worst_frame), at(*edited, map(worst_frame)));
    // A slope outside the keys has the rounding error of the span from which it is computed.
    const double tolerance = 1e-12 + 64 * epsilon * 100 / shortest_span(curve);
    if (worst > tolerance) REQUIRE(worst <= tolerance);
  }
  CHECK(edited_curves > rounds(8000));
}

TEST_CASE("moving all keys moves the curve", "[timeline][edit]") {
  check_equivariance(
      3, false, 1, [](const Curve<1>& curve) { return move_keys(curve, 3.3, {0.7}); },
      [](double t) { return t + 3.3; }, [](double v) { return v + 0.7; });
}

TEST_CASE("scaling the keys scales the curve", "[timeline][edit]") {
  check_equivariance(
      4, false, 1.7,
      [](const Curve<1>& curve) {
        return scale(curve, {1.5, 1.7, {0.25}, {-2.3}});
      },
      [](double t) { return 1.5 + 1.7 * (t - 1.5); },
      [](double v) { return 0.25 + -2.3 * (v - 0.25); });
}

TEST_CASE("scaled keys are those of the scaled curve", "[timeline][edit]") {
  Whim whim(10);
  int same = 0;
  for (int round = 0; round < rounds(2000); ++round) {
    const Curve<1> curve = some_curve(whim, 6);
    const Scaling<1> scaling{1.5, 1.7, {0.25}, {-2.3}};
    const CurveKeys<1> keys = scaled_keys(curve.keys(), scaling);
    const Curve<1> scaled = scale(curve, scaling).value();
    if (scaled.keys() == keys) ++same;
    // Where rounding decides about an automatic slope, the scaled curve has it as a number.
    if (scaled.keys().keys.size() != keys.keys.size()) continue;
    for (std::size_t k = 0; k < keys.keys.size(); ++k) {
      Key<1> one = scaled.keys().keys[k], other = keys.keys[k];
      for (Key<1>* key : {&one, &other}) key->in = key->out = {};
      REQUIRE(one == other);
    }
  }
  CHECK(same > rounds(1900));
  for (int round = 0; round < rounds(1000); ++round) {
    const Curve<1> curve = some_curve(whim, 6);
    const CurveKeys<1> flat = scaled_keys(curve.keys(), {0, 1, {3}, {0}});
    for (int i = 0; i < 10; ++i) REQUIRE(at(make(flat), some_frame(whim, curve)) == 3);
    CHECK(scaled_keys(curve.keys(), {7, 1, {3}, {1}}) == curve.keys());
  }
}

TEST_CASE("a reversed curve is the curve run backwards", "[timeline][edit]") {
  check_equivariance(
      5, true, 1, [](const Curve<1>& curve) { return reverse(curve, 2.1); },
      [](double t) { return 2 * 2.1 - t; }, [](double v) { return v; });
}

TEST_CASE("a negative time factor reverses", "[timeline][edit]") {
  check_equivariance(
      6, true, 0.6,
      [](const Curve<1>& curve) {
        return scale(curve, {-1.5, -0.6, {0.0}, {1.0}});
      },
      [](double t) { return -1.5 - 0.6 * (t + 1.5); }, [](double v) { return v; });
}

TEST_CASE("a curve reversed twice is the curve", "[timeline][edit]") {
  check_equivariance(
      7, true, 1,
      [](const Curve<1>& curve) {
        const auto once = reverse(curve, 2.1);
        return once ? reverse(*once, 2.1) : once;
      },
      [](double t) { return t; }, [](double v) { return v; });

  // About frame 0 there is no rounding: then the keys are the same, numbers included.
  std::vector<Key<1>> keys = {key(0, 1, of_slope(0.25)), key(4, 2, of_handle(0, 0)), key(9, -1)};
  keys[1].in = of_handle(-1, 0.5);
  keys[1].out = of_handle(2, 0.5);
  keys[1].next = of_ease(Ease::Bounce, EaseSide::In);
  keys[1].left = Value<1>{7};
  keys[2].next = of_segment(SegmentKind::Step);
  const Curve<1> curve = make(keys);
  CHECK(reverse(reverse(curve, 0).value(), 0)->keys() == curve.keys());
}

TEST_CASE("the limits on both sides of a jump change places", "[timeline][edit]") {
  const Curve<1> curve =
      make({key(0, 1, of_segment(SegmentKind::Linear)),
            with_left(key(4, 5, of_segment(SegmentKind::Linear)), 3), key(8, 6)});
  const Curve<1> back = reverse(curve, 4).value();
  CHECK(back.left_value(4)[0] == 5);
  CHECK(at(back, 4) == 3);
  CHECK(at(back, 6) == 2);
  CHECK(at(back, 2) == 5.5);

  const Curve<1> steps = make({key(0, 1, of_segment(SegmentKind::Step)), key(4, 5)});
  const Curve<1> steps_back = reverse(steps, 2).value();
  CHECK(steps_back.keys().keys[0].next.kind == SegmentKind::StepNext);
  CHECK(at(steps_back, 0) == 5);
  CHECK(at(steps_back, 1) == 1);
}

TEST_CASE("edits keep an inner loop where it can stay", "[timeline][edit]") {
  CurveKeys<1> keys;
  const Interpolation linear = of_segment(SegmentKind::Linear);
  keys.keys = {key(-5, 4, linear), key(0, 1, linear), key(3, 5, linear), key(30, 2, linear)};
  keys.loop = Loop<1>{0, 4, 1, 2, {0.5}};
  const Curve<1> curve = make(keys);
  const Curve<1> later = move_keys(curve, 10, {1}).value();
  CHECK(later.keys().loop == Loop<1>{10, 14, 1, 2, {0.5}});
  const Curve<1> back = reverse(curve, 0).value();
  CHECK(back.keys().loop == Loop<1>{-4, 0, 2, 1, {-0.5}});
  const Curve<1> wide = scale(curve, {0, 2, {0}, {3}}).value();
  CHECK(wide.keys().loop == Loop<1>{0, 8, 1, 2, {1.5}});
  for (double t = -8; t < 35; t += 0.25) {
    CAPTURE(t);
    CHECK_THAT(at(later, t + 10), WithinAbs(at(curve, t) + 1, 1e-14));
    CHECK_THAT(at(back, -t), WithinAbs(at(curve, t), 1e-14));
    CHECK_THAT(at(wide, 2 * t), WithinAbs(3 * at(curve, t), 1e-14));
  }
}

TEST_CASE("edits leave tangents automatic where they may", "[timeline][edit]") {
  std::vector<Key<1>> keys;
  for (int k = 0; k < 12; ++k) keys.push_back(key(k * 10, k * k));
  for (const TangentKind kind : {TangentKind::Auto, TangentKind::Spline, TangentKind::Smooth,
                                 TangentKind::Free, TangentKind::Plateau, TangentKind::Clamped}) {
    const Curve<1> curve = make(with_kinds({keys}, kind));
    const auto kinds_stay = [&](const Curve<1>& edited) {
      return std::all_of(
          edited.keys().keys.begin(), edited.keys().keys.end(),
          [&](const Key<1>& each) { return each.in.kind == kind && each.out.kind == kind; });
    };
    CAPTURE(static_cast<int>(kind));
    CHECK(kinds_stay(move_keys(curve, 0.1, {0.3}).value()));
    CHECK(kinds_stay(scale(curve, {0, 1.1, {0}, {0.7}}).value()));
    CHECK(kinds_stay(reverse(curve, 0.1).value()));
  }
  // Inserting writes as numbers only the tangents that depend on the new key.
  const Curve<1> edited = insert_key(make(keys), 55).value();
  CHECK(edited.keys().keys[4].in.kind == TangentKind::Auto);
  CHECK(edited.keys().keys[4].out.kind == TangentKind::Auto);
  CHECK(edited.keys().keys[5].out.kind == TangentKind::Slope);
  CHECK(edited.keys().keys[7].in.kind == TangentKind::Slope);
  CHECK(edited.keys().keys[8].in.kind == TangentKind::Auto);
}

TEST_CASE("easings made of cubics take a key", "[timeline][edit]") {
  Whim whim(8);
  for (const Ease ease : {Ease::Quad, Ease::Cubic, Ease::Back, Ease::Bounce}) {
    for (const EaseSide side : {EaseSide::In, EaseSide::Out, EaseSide::InOut}) {
      const Curve<1> curve = make({key(3, -2, of_ease(ease, side)), key(20, 5)});
      for (int round = 0; round < 100; ++round) {
        const double frame = whim.between(3, 20);
        const Curve<1> edited = insert_key(curve, frame).value();
        const double t = whim.between(3, 20);
        CAPTURE(static_cast<int>(ease), static_cast<int>(side), frame, t);
        REQUIRE_THAT(at(edited, t), WithinAbs(at(curve, t), 1e-13));
        REQUIRE_THAT(edited.velocity(t)[0], WithinAbs(curve.velocity(t)[0], 1e-11));
      }
    }
  }
}

TEST_CASE("a key is put between keys a billionth of a frame apart", "[timeline][edit]") {
  Whim whim(9);
  for (int round = 0; round < rounds(1000); ++round) {
    const double start = whim.between(0, 1000);
    const double end = start + 1e-9;
    std::vector<Key<1>> keys = {key(start - 1, 3), key(start, 1), key(end, 2), key(end + 1, 0)};
    keys[1].out = of_handle(1e-9 * whim.between(0, 1), whim.between(-1, 1));
    keys[2].in = of_handle(-1e-9 * whim.between(0, 1), whim.between(-1, 1));
    const Curve<1> curve = make(keys);
    const auto edited = insert_key(curve, whim.between(start, end));
    REQUIRE(edited);
    for (int i = 0; i < 5; ++i) {
      const double t = whim.between(start, end);
      REQUIRE(miss(at(*edited, t), curve, t, 8 * epsilon * t) <= 1e-12);
    }
  }
}

TEST_CASE("deleting an inserted key restores the curve", "[timeline][edit]") {
  Whim whim(10);
  int rejoined = 0;
  for (int round = 0; round < rounds(10000); ++round) {
    CurveKeys<1> keys = whim.keys(6);
    for (std::size_t k = 0; k < keys.keys.size(); ++k) {
      Key<1>& each = keys.keys[k];
      if (each.next.kind == SegmentKind::Easing) each.next.kind = SegmentKind::CubicBezier;
      if (each.in.kind != TangentKind::Handle) each.in.kind = TangentKind::Slope;
      if (each.out.kind != TangentKind::Handle) each.out.kind = TangentKind::Slope;
    }
    const Curve<1> curve = make(keys);
    if (keys.keys.size() < 2) continue;
    const double first = keys.keys.front().frame;
    const double last = keys.keys.back().frame;
    const double frame = first + whim.between(0.01, 0.99) * (last - first);
    const auto edited = insert_key(curve, frame);
    REQUIRE(edited);
    std::size_t index = 0;
    while (edited->keys().keys[index].frame != frame) ++index;
    const auto restored = delete_key(*edited, index);
    REQUIRE(restored);
    ++rejoined;
    for (int i = 0; i < 4; ++i) {
      const double t = some_frame(whim, curve);
      // The handles are reconstructed from their parts, the smaller ones with fewer digits.
      const double off = miss(at(*restored, t), curve, t, 1e-10);
      if (off <= 1e-9 * (size_of(curve) + std::fabs(at(curve, t)))) continue;
      CAPTURE(round, frame, t, at(curve, t), at(*restored, t));
      REQUIRE(off == 0);
    }
  }
  CHECK(rejoined > rounds(5000));
}

TEST_CASE("deleting a key leaves its neighbours to the rules", "[timeline][edit]") {
  const std::vector<Key<1>> keys = {key(0, 0), key(5, 9), key(10, 2), key(20, 4)};
  const Curve<1> edited = delete_key(make(keys), 1).value();
  CHECK(edited.keys().keys == std::vector<Key<1>>{keys[0], keys[2], keys[3]});
}

TEST_CASE("deleting keys at once is deleting one after the other", "[timeline][edit]") {
  Whim whim(11);
  int joined = 0;
  for (int round = 0; round < rounds(3000); ++round) {
    CurveKeys<1> keys = whim.keys(6);
    for (Key<1>& each : keys.keys)
      if (each.next.kind == SegmentKind::Easing) each.next.kind = SegmentKind::Bezier;
    Curve<1> curve = make(keys);
    const double first = keys.keys.front().frame;
    const double last = keys.keys.back().frame;
    for (int more = 0; more < 3 && first < last; ++more)
      if (auto longer = insert_key(curve, first + whim.between(0.01, 0.99) * (last - first)))
        curve = *std::move(longer);
    std::vector<std::size_t> deleted;
    for (std::size_t k = 0; k < curve.keys().keys.size(); ++k)
      if (whim.between(0, 1) < 0.4) deleted.push_back(k);
    Checked<Curve<1>> one_by_one = curve;
    for (std::size_t k = 0; k < deleted.size() && one_by_one; ++k)
      one_by_one = delete_key(*one_by_one, deleted[k] - k);
    const auto at_once = delete_keys(curve, deleted);
    CAPTURE(round);
    REQUIRE(at_once.has_value() == one_by_one.has_value());
    if (!at_once) continue;
    REQUIRE(at_once->keys() == one_by_one->keys());
    for (const Key<1>& key : at_once->keys().keys)
      joined += std::find(curve.keys().keys.begin(), curve.keys().keys.end(), key) ==
                curve.keys().keys.end();
  }
  CHECK(joined > rounds(100));
}

TEST_CASE("moving one key leaves the others", "[timeline][edit]") {
  CurveKeys<1> keys;
  keys.keys = {key(0, 0), with_left(key(5, 9), 8), key(10, 2)};
  keys.loop = Loop<1>{5, 9, 0, 1, {0}};
  const Curve<1> edited = move_key(make(keys), 1, 1, {-2}).value();
  CHECK(edited.keys().keys[0] == keys.keys[0]);
  CHECK(edited.keys().keys[1].frame == 6);
  CHECK(edited.keys().keys[1].value[0] == 7);
  CHECK((*edited.keys().keys[1].left)[0] == 6);
  CHECK(edited.keys().loop->from == 6);
  CHECK(edited.keys().loop->to == 9);
}

TEST_CASE("edits of vectors treat their components alike", "[timeline][edit]") {
  CurveKeys<3> keys;
  keys.keys = {{.frame = 0, .value = {0, 1, 2}},
               {.frame = 10, .value = {5, -1, 2}},
               {.frame = 16, .value = {1, 4, 3}}};
  keys.keys[0].out.length = 8;
  keys.keys[1].next = of_ease(Ease::Bounce, EaseSide::Out);
  const Curve<3> curve = Curve<3>::make(keys).value();
  const Curve<3> split = insert_key(insert_key(curve, 4).value(), 12).value();
  const Curve<3> later = move_keys(curve, 2, {1, 2, 3}).value();
  const Curve<3> back = reverse(curve, 8).value();
  const Curve<3> wide = scale<3>(curve, {0, 2, {0, 0, 0}, {1, -1, 3}}).value();
  const Curve<3> restored = delete_key(insert_key(curve, 4).value(), 1).value();
  const Value<3> sign = {1, -1, 3};
  for (double t = -2; t < 20; t += 0.3) {
    for (int c = 0; c < 3; ++c) {
      const double value = curve.value(t)[c];
      CAPTURE(t, c);
      CHECK_THAT(split.value(t)[c], WithinAbs(value, 1e-13));
      CHECK_THAT(later.value(t + 2)[c], WithinAbs(value + 1 + c, 1e-13));
      CHECK_THAT(back.value(16 - t)[c], WithinAbs(value, 1e-13));
      CHECK_THAT(wide.value(2 * t)[c], WithinAbs(sign[c] * value, 1e-13));
      CHECK_THAT(restored.value(t)[c], WithinAbs(value, 1e-12));
    }
  }
}

template <class Result>
void check_error(const Result& result, const std::string& part) {
  REQUIRE(!result);
  CHECK_THAT(result.error().message, contains_text(part));
}

TEST_CASE("edits that cannot be are refused with the reason", "[timeline][edit]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const Curve<1> curve =
      make({key(0, 0), key(5, 9, of_ease(Ease::Sine, EaseSide::In)), key(10, 2)});
  check_error(insert_key(curve, nan), "must be finite");
  check_error(insert_key(curve, infinity), "must be finite");
  check_error(insert_key(curve, 7), "has the easing sineIn");
  CHECK(insert_key(curve, 7).error().index == 1);
  CurveKeys<1> repeats = curve.keys();
  repeats.after.kind = OutsideKind::Repeat;
  check_error(insert_key(make(repeats), 12), "after shows copies");
  check_error(insert_key(make(repeats), -1), "after shows copies");

  check_error(delete_key(curve, 3), "there is no key 3; the curve has keys 0 to 2");
  check_error(delete_key(make({key(0, 1)}), 0), "only one");
  check_error(delete_keys(curve, {0, 1, 2}), "all others cannot be deleted");
  CurveKeys<1> looped = curve.keys();
  looped.loop = Loop<1>{5, 9, 0, 1, {0}};
  check_error(delete_key(make(looped), 1), "the loop starts from it");

  check_error(move_key(curve, 3, 0, {0}), "there is no key 3");
  check_error(move_key(curve, 1, 5, {0}), "frames must strictly increase");
  check_error(move_key(curve, 1, nan, {0}), "finite");
  check_error(move_key(curve, 1, 0, {infinity}), "finite");
  check_error(move_keys(curve, nan, {0}), "finite");
  check_error(move_keys(curve, 0, {nan}), "finite");
  check_error(move_keys(curve, 1e100, {0}), "frames must strictly increase");
  // So far away that the loop has no length.
  CurveKeys<1> short_loop{.keys = {key(0, 0), key(64, 1)}};
  short_loop.loop = Loop<1>{0, 0.5, 0, 1, {0}};
  check_error(move_keys(make(short_loop), 1e16, {0}), "frames must strictly increase");
  check_error(reverse(make(short_loop), 1e16), "frames must strictly increase");

  check_error(scale(curve, {0, 0, {0}, {1}}), "time factor is 0");
  check_error(scale(curve, {0, 1, {0}, {0}}), "value factor is 0");
  check_error(scale(curve, {nan, 1, {0}, {1}}), "finite");
  check_error(scale(curve, {0, infinity, {0}, {1}}), "finite");
  check_error(scale(curve, {0, 1, {nan}, {1}}), "finite");
  CurveKeys<3> elastic;
  elastic.keys = {{.frame = 0}, {.frame = 1, .value = {1, 1, 1}}};
  elastic.keys[0].next = of_ease(Ease::Elastic, EaseSide::Out);
  elastic.keys[0].next.amplitude = 2;
  const Curve<3> swing = Curve<3>::make(elastic).value();
  check_error(scale<3>(swing, {0, 1, {}, {1, 2, 1}}), "one amplitude");
  CHECK(scale<3>(swing, {0, 1, {}, {2, -2, 2}}));

  check_error(reverse(curve, nan), "finite");
  CurveKeys<1> held = curve.keys();
  held.keys[2].left = Value<1>{4};
  held.after.kind = OutsideKind::Repeat;
  held.after.count = 2;
  check_error(reverse(make(held), 0), "jumps, and a side that repeats keeps its value");
  CHECK(reverse(make(held), 0).error().index == 2);
}

TEST_CASE("no edit writes a -0", "[timeline][edit]") {
  Whim whim(11);
  const auto check = [](CurveKeys<1> keys) {
    for_each_number(keys,
                    [](double number) { REQUIRE_FALSE((number == 0 && std::signbit(number))); });
    for (const Key<1>& key : keys.keys) REQUIRE_FALSE((key.frame == 0 && std::signbit(key.frame)));
  };
  // Steps of whole numbers, as of a hand that rests: many values and slopes are 0.
  for (int round = 0; round < rounds(1000); ++round) {
    CurveKeys<1> keys;
    for (int k = 0; k < 12; ++k) {
      const auto next = whim.once_in(2) ? Interpolation::Kind::Linear : Interpolation::Kind::Bezier;
      keys.keys.push_back(key(k - 6, whim.upto(2) - 1, {.kind = next}));
    }
    const Curve<1> curve = make(keys);
    CAPTURE(round);
    check(simplify(curve, -6, 5, 0.4).value().keys);
    check(bake_keys(curve, -6, 5, 0.5).value());
    check(insert_key(curve, whim.between(-6, 5)).value().keys());
    check(move_keys(curve, 3, {-1}).value().keys());
    check(reverse(curve, 0).value().keys());
    check(scale(curve, {0, 1, {0}, {-1}}).value().keys());
  }
}

}  // namespace
}  // namespace pliant::testing
