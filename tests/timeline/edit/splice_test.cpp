#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "pliant/timeline/edit/edit.hpp"
#include "pliant/timeline/edit/preserve.hpp"
#include "support/catch.hpp"
#include "support/sanitized.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

template <int D>
Curve<D> random_curve(Whim& whim, int most) {
  return Curve<D>::make(random_keys<D>(whim, most)).value();
}

/// Frames from one to another, both included.
std::vector<double> frames_between(double from, double to, int count = 23) {
  std::vector<double> frames;
  for (int k = 0; k <= count; ++k) frames.push_back(from + (to - from) * k / count);
  frames.back() = to;
  return frames;
}

/// Whether two curves have the same bits from one frame to another, without what is beyond.
template <int D>
bool has_same_values(const Curve<D>& a, const Curve<D>& b, double from, double to) {
  return std::ranges::all_of(frames_between(from, to), [&](double frame) {
    return a.value(frame) == b.value(frame) &&
           (frame == from || (a.left_value(frame) == b.left_value(frame) &&
                              a.left_velocity(frame) == b.left_velocity(frame))) &&
           (frame == to || a.velocity(frame) == b.velocity(frame));
  });
}

/// Whether a line beyond an end key is the same, as far as its slope may be rounded.
template <int D>
bool has_same_line(const Curve<D>& a, const Curve<D>& b, double from, double to) {
  return std::ranges::all_of(frames_between(from, to), [&](double frame) {
    const Value<D> one = a.value(frame), other = b.value(frame), slope = a.velocity(frame);
    for (int c = 0; c < D; ++c) {
      const double bound = 5 * epsilon * std::fabs(slope[c]) * std::fabs(to - from) +
                           2 * epsilon * std::fabs(one[c]);
      if (!(std::fabs(one[c] - other[c]) <= bound)) return false;
    }
    return true;
  });
}

template <int D>
bool repeats(const Extrapolation<D>& side) {
  return side.kind == Extrapolation<D>::Kind::Repeat ||
         side.kind == Extrapolation<D>::Kind::RepeatOffset ||
         side.kind == Extrapolation<D>::Kind::Mirror;
}

/// Whether a key is the same, but for automatic tangents that became numbers and lengths that were
/// corrected.
template <int D>
bool is_same_key(const Key<D>& old, const Key<D>& now) {
  return old.frame == now.frame && old.value == now.value && old.left == now.left &&
         old.next == now.next;
}

template <int D>
void check_splices(std::uint64_t seed) {
  Whim whim(seed);
  int empty = 0, alone = 0, whole = 0;
  for (int round = 0; round < rounds(3000); ++round) {
    const Curve<D> curve = random_curve<D>(whim, 9);
    const Curve<D> piece = random_curve<D>(whim, 5);
    const auto& olds = curve.keys().keys;
    const auto& given = piece.keys().keys;
    const double first = given.front().frame - (whim.once_in(3) ? 0 : whim.size(-3, 1));
    const double last = given.back().frame + (whim.once_in(3) ? 0 : whim.size(-3, 1));
    const auto spliced = splice(curve, first, last, piece);
    CAPTURE(seed, round, first, last);
    if (!spliced) {
      // A joining segment may be too short for its easing, or have too many periods.
      CAPTURE(spliced.error().message);
      FAIL("it is refused");
    }
    const auto& keys = spliced->keys().keys;
    std::size_t begin = 0, behind = 0;
    for (const Key<D>& key : olds) {
      if (key.frame < first) ++begin;
      if (key.frame > last) ++behind;
    }
    if (begin + behind == 0) ++alone;
    if (begin + behind == olds.size()) ++empty;
    if (begin > 0 && behind > 0) ++whole;
    REQUIRE(keys.size() == begin + given.size() + behind);
    for (std::size_t k = 0; k < begin; ++k) REQUIRE(is_same_key(olds[k], keys[k]));
    for (std::size_t k = 0; k < given.size(); ++k) REQUIRE(is_same_key(given[k], keys[begin + k]));
    for (std::size_t k = 0; k < behind; ++k)
      REQUIRE(is_same_key(olds[olds.size() - behind + k], keys[begin + given.size() + k]));

    // All values between keys of one side are the same to the bit.
    if (begin > 1)
      REQUIRE(has_same_values(curve, *spliced, olds.front().frame, olds[begin - 1].frame));
    if (behind > 1)
      REQUIRE(
          has_same_values(curve, *spliced, olds[olds.size() - behind].frame, olds.back().frame));
    if (given.size() > 1)
      REQUIRE(has_same_values(piece, *spliced, given.front().frame, given.back().frame));
    for (const Key<D>& key : keys) REQUIRE(spliced->value(key.frame) == key.value);
    // So is what follows from an end that stays.
    const CurveKeys<D>& of = curve.keys();
    if (begin > 0 && !repeats(of.before))
      REQUIRE(has_same_line(curve, *spliced, olds.front().frame - 50,
                            std::nextafter(olds.front().frame, -1e300)));
    if (behind > 0 && !repeats(of.after))
      REQUIRE(has_same_line(curve, *spliced, std::nextafter(olds.back().frame, 1e300),
                            olds.back().frame + 50));
    if (begin == 0) REQUIRE(spliced->keys().before == of.before);
    if (behind == 0) REQUIRE(spliced->keys().after == of.after);
  }
  CHECK(empty > rounds(3000) / 100);
  CHECK(alone > rounds(3000) / 100);
  CHECK(whole > rounds(3000) / 100);
}

TEST_CASE("a splice keeps the curve outside and the piece inside", "[timeline][edit][splice]") {
  check_splices<1>(1);
  check_splices<3>(2);
}

TEST_CASE("a splice leaves tangents that do not depend on the joins", "[timeline][edit][splice]") {
  Whim whim(5);
  for (int round = 0; round < rounds(1000); ++round) {
    CurveKeys<1> keys = whim.keys(9);
    CurveKeys<1> given = whim.keys(4);
    // Without those that depend on all keys.
    const auto is_local = [](const Tangent<1>& tangent) {
      return tangent.kind != TangentKind::Smooth && tangent.kind != TangentKind::Free &&
             tangent.kind != TangentKind::Clamped;
    };
    for (CurveKeys<1>* const each : {&keys, &given}) {
      each->before = each->after = {};
      each->overshoot = Overshoot::Limit;
      for (Key<1>& key : each->keys) {
        if (!is_local(key.in)) key.in = {};
        if (!is_local(key.out)) key.out = {};
      }
    }
    const double first = given.keys.front().frame, last = given.keys.back().frame;
    const Curve<1> result = splice(make(keys), first, last, make(given)).value();
    const auto& now = result.keys().keys;
    CAPTURE(round);
    std::size_t begin = 0;
    while (begin < keys.keys.size() && keys.keys[begin].frame < first) ++begin;
    // Only the keys beside a join have new neighbours.
    for (std::size_t k = 0; k + 1 < begin; ++k) REQUIRE(now[k] == keys.keys[k]);
    for (std::size_t k = 1; k + 1 < given.keys.size(); ++k)
      REQUIRE(now[begin + k] == given.keys[k]);
    const std::size_t behind = now.size() - begin - given.keys.size();
    for (std::size_t k = 0; k + 1 < behind; ++k)
      REQUIRE(now[now.size() - 1 - k] == keys.keys[keys.keys.size() - 1 - k]);
  }
}

TEST_CASE("a splice of what is there changes nothing", "[timeline][edit][splice]") {
  Whim whim(9);
  for (int round = 0; round < rounds(500); ++round) {
    const Curve<1> curve = random_curve<1>(whim, 6);
    const auto& keys = curve.keys().keys;
    const auto spliced = splice(curve, keys.front().frame, keys.back().frame, curve);
    REQUIRE(spliced);
    CHECK(spliced->keys() == curve.keys());
  }
}

TEST_CASE("a splice keeps a loop whose copies stay", "[timeline][edit][splice]") {
  CurveKeys<1> keys{.keys = {key(0, 0), key(2, 5), key(4, 1), key(20, 3), key(25, 4)}};
  keys.loop = Loop<1>{.from = 0, .to = 4, .before = 1, .after = 2, .offset = {0.5}};
  const Curve<1> curve = make(keys);
  const Curve<1> piece = make({key(21, 7), key(22, 8)});
  const Curve<1> beside = splice(curve, 20, 25, piece).value();
  CHECK(beside.keys().loop == keys.loop);
  CHECK(beside.keys().keys.size() == 5);
  CHECK(has_same_values(curve, beside, -4, 12));
  // The piece takes the place of some copies: the others become keys.
  const Curve<1> across = splice(curve, 7, 24, make({key(8, 7), key(9, 8)})).value();
  CHECK_FALSE(across.keys().loop);
  CHECK(has_same_values(curve, across, -4, 6));
  CHECK(across.keys().keys.back().frame == 25);
  // The piece has copies.
  CurveKeys<1> looped{.keys = {key(6, 1), key(7, 2)}};
  looped.loop = Loop<1>{.from = 6, .to = 8, .after = 2};
  const Curve<1> with_copies = splice(curve, 5, 14, make(looped)).value();
  CHECK(has_same_values(make(looped), with_copies, 6, 12));
  // A loop without copies has no effect; it stays with its key.
  keys.loop = Loop<1>{.from = 2, .to = 4};
  CHECK(splice(make(keys), 20, 25, piece)->keys().loop == keys.loop);
  CHECK_FALSE(splice(make(keys), 1, 3, make({key(1, 0), key(3, 0)}))->keys().loop);
}

TEST_CASE("a random loop survives a splice beside it", "[timeline][edit][splice]") {
  Whim whim(11);
  int kept = 0;
  for (int round = 0; round < rounds(1000); ++round) {
    CurveKeys<1> keys = whim.keys(8);
    const auto from = static_cast<std::size_t>(whim.upto(static_cast<int>(keys.keys.size()) - 1));
    keys.loop = Loop<1>{.from = keys.keys[from].frame,
                        .to = keys.keys[from].frame + whim.size(-1, 1),
                        .before = whim.upto(2),
                        .after = whim.upto(2),
                        .offset = {whim.between(-1, 1)}};
    const auto curve = Curve<1>::make(keys);
    if (!curve) continue;  // copies on one frame
    const Curve<1> piece = random_curve<1>(whim, 4);
    const double first = piece.keys().keys.front().frame;
    const double last = piece.keys().keys.back().frame;
    const auto spliced = splice(*curve, first, last, piece);
    REQUIRE(spliced);
    if (spliced->keys().loop) ++kept;
    CAPTURE(round, spliced->keys().loop.has_value());
    const auto written = timeline::without_loop(keys)->keys;
    std::vector<double> before, behind;
    for (const Key<1>& each : written) {
      if (each.frame < first) before.push_back(each.frame);
      if (each.frame > last) behind.push_back(each.frame);
    }
    if (before.size() > 1)
      REQUIRE(has_same_values(*curve, *spliced, before.front(), before.back()));
    if (behind.size() > 1)
      REQUIRE(has_same_values(*curve, *spliced, behind.front(), behind.back()));
    REQUIRE(has_same_values(piece, *spliced, first, last));
  }
  CHECK(kept > 0);
}

TEST_CASE("a splice keeps rules for overshooting tangents if it can", "[timeline][edit][splice]") {
  const auto long_keys = [](double first, Overshoot rule) {
    CurveKeys<1> keys{.keys = {key(first, 0), key(first + 3, 5), key(first + 6, 1)},
                      .overshoot = rule};
    keys.keys[0].out = of_slope(2, 4);
    keys.keys[1].in = of_slope(1, 0.1);
    keys.keys[1].out = of_handle(9, 3);
    return keys;
  };
  using enum Overshoot;
  for (const Overshoot rule : {Limit, KeepStart, Contain})
    for (const Overshoot other : {Limit, KeepStart, Contain}) {
      const Curve<1> curve = make(long_keys(0, rule)), piece = make(long_keys(10, other));
      const Curve<1> spliced = splice(curve, 9, 30, piece).value();
      CAPTURE(static_cast<int>(rule), static_cast<int>(other));
      CHECK(has_same_values(curve, spliced, 0, 6));
      CHECK(has_same_values(piece, spliced, 10, 16));
      if (rule == other) CHECK(spliced.keys().keys[4] == piece.keys().keys[1]);
      // `contain` would shorten what the others allow.
      CHECK(spliced.keys().overshoot == (rule == Contain && other != Contain ? Limit : rule));
    }
  // Under `error` the piece is corrected, and a joining segment is not.
  CurveKeys<1> strict{.keys = {key(0, 0), key(3, 5)}, .overshoot = Error};
  const Curve<1> strictly = splice(make(strict), 9, 30, make(long_keys(10, Limit))).value();
  CHECK(strictly.keys().overshoot == Error);
  CHECK(has_same_values(make(long_keys(10, Limit)), strictly, 10, 16));
  strict.keys[1].out = of_slope(1, 100);
  const auto refused = splice(make(strict), 9, 30, make({key(10, 1)}));
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, contains_text("time would run backwards"));
}

TEST_CASE("a splice is refused with a reason", "[timeline][edit][splice]") {
  const Curve<1> curve = make({key(0, 0), key(9, 5)});
  const auto message = [&](double first, double last, const Curve<1>& piece) {
    const auto spliced = splice(curve, first, last, piece);
    return spliced ? "" : spliced.error().message;
  };
  const Curve<1> piece = make({key(3, 0), key(6, 1)});
  constexpr double infinity = std::numeric_limits<double>::infinity();
  CHECK(message(-infinity, 6, piece) == "first is -inf; it must be a finite frame");
  CHECK(message(3, std::nan(""), piece) == "last is nan; it must be a finite frame");
  CHECK(message(6, 3, piece) == "last is frame 3; it must not come before first, frame 6");
  CHECK(message(4, 6, piece) == "the piece has a key at frame 3; it must be from frame 4 to 6");
  CHECK(splice(curve, 3, 5, piece).error().index == 1);
  CurveKeys<1> looped{.keys = {key(3, 1), key(4, 2)}};
  looped.loop = Loop<1>{.from = 3, .to = 5, .after = 9};
  CHECK(message(3, 6, make(looped)) ==
        "the piece has a key at frame 7; it must be from frame 3 to 6");
  CHECK(message(3, 3, make({key(3, 1)})).empty());
}

}  // namespace
}  // namespace pliant::testing
