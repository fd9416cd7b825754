// What scaled keys are as curves; their text is tested with that of the other operations.

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "pliant/document/document.hpp"
#include "pliant/scene/channels.hpp"
#include "pliant/timeline/edit/edit.hpp"
#include "support/catch.hpp"
#include "support/sanitized.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

/// A document with these keys, and what an operation makes of them.
template <int D>
class Animated {
 public:
  explicit Animated(const CurveKeys<D>& keys) {
    auto document = SceneDocument::from_text(
        "<scene version=\"1\" start=\"1\" end=\"9\">\n  <surface name=\"s\"><grid columns=\"5\" "
        "rows=\"5\"/></surface>\n  <point name=\"f\"/>\n</scene>\n",
        "shot.xml", "");
    REQUIRE(document);
    document_.emplace(*std::move(document));
    const auto change = document_->apply({edit::SetCurve{path(), keys}});
    if (!change) UNSCOPED_INFO(change.error().message);
    REQUIRE(change);
  }

  static std::string path() { return D == 1 ? "f.magnitude" : "f.center"; }

  CurveKeys<D> keys() const {
    const auto channels = channels_of(document_->scene());
    const auto found = std::ranges::find(channels, path(), &NamedChannel::path);
    REQUIRE(found != channels.end());
    return std::get<const Channel<D>*>(found->channel)->curve().keys();
  }

  /// Scales the keys at these indices. False: it is refused.
  bool scale(const std::vector<std::size_t>& some, edit::ScaleKeys how) {
    edit::KeysOf chosen{path(), {}};
    for (const std::size_t k : some) chosen.frames.push_back(keys().keys[k].frame);
    how.keys = {chosen};
    const auto change = document_->apply({how});
    if (!change) message_ = change.error().message;
    return change.has_value();
  }

  std::string text() const { return document_->text(); }
  const std::string& message() const { return message_; }

 private:
  std::optional<SceneDocument> document_;
  std::string message_;
};

std::vector<std::size_t> all_of(std::size_t count) {
  std::vector<std::size_t> indices;
  for (std::size_t k = 0; k < count; ++k) indices.push_back(k);
  return indices;
}

template <int D>
std::vector<double> numbers_of(const Value<D>& value) {
  return {value.begin(), value.end()};
}

/// What a file keeps of keys.
template <int D>
CurveKeys<D> written(const CurveKeys<D>& keys) {
  return Animated<D>(keys).keys();
}

/// Keys, sometimes with a loop, as a file can have them.
template <int D>
CurveKeys<D> some_keys(Whim& whim) {
  using Outside = Extrapolation<D>;
  CurveKeys<D> keys = random_keys<D>(whim, 6);
  for (Outside* side : {&keys.before, &keys.after})
    if (side->kind < Outside::Kind::Repeat) side->count.reset();
  keys = written(keys);
  if (whim.once_in(3)) {
    const double last = keys.keys.back().frame;
    keys.loop = Loop<D>{keys.keys.front().frame, last + whim.upto(1) * 2.5 + 0.5};
    keys.loop->offset.fill(0.5);
    keys.loop->after = 2;
    return written(keys);
  }
  return keys;
}

template <int D>
Scaling<D> some_scaling(Whim& whim) {
  Scaling<D> scaling{.frame = whim.between(-20, 20), .time_factor = whim.size(-0.5, 0.5)};
  const double factor = whim.once_in(8) ? 0 : whim.between(-2, 2);
  for (std::size_t c = 0; c < D; ++c) {
    scaling.value[c] = whim.between(-9, 9);
    scaling.value_factor[c] = whim.once_in(4) ? -factor : factor;
  }
  return scaling;
}

template <int D>
edit::ScaleKeys operation_of(const Scaling<D>& scaling) {
  return {.keys = {},
          .frame = scaling.frame,
          .time_factor = scaling.time_factor,
          .value = numbers_of<D>(scaling.value),
          .value_factor = numbers_of<D>(scaling.value_factor)};
}

template <int D>
double distance(const Tangent<D>& a, const Tangent<D>& b) {
  if (a.kind != b.kind || a.length.has_value() != b.length.has_value()) return INFINITY;
  double far = std::fabs(a.handle_frames - b.handle_frames);
  if (a.length) far = std::max(far, std::fabs(*a.length - *b.length));
  for (std::size_t c = 0; c < D; ++c)
    far = std::max({far, std::fabs(a.slope[c] - b.slope[c]),
                    std::fabs(a.handle_value[c] - b.handle_value[c])});
  return far;
}

/// The greatest difference of two numbers of keys; infinite if anything else differs.
template <int D>
double distance(const CurveKeys<D>& a, const CurveKeys<D>& b) {
  if (a.keys.size() != b.keys.size() || a.loop.has_value() != b.loop.has_value()) return INFINITY;
  double far = 0;
  const auto compare = [&](double x, double y) { far = std::max(far, std::fabs(x - y)); };
  for (std::size_t k = 0; k < a.keys.size(); ++k) {
    const Key<D>&one = a.keys[k], &other = b.keys[k];
    if (one.next.kind != other.next.kind || one.left.has_value() != other.left.has_value())
      return INFINITY;
    compare(one.frame, other.frame);
    compare(one.next.amplitude.value_or(0), other.next.amplitude.value_or(0));
    compare(one.next.period.value_or(0), other.next.period.value_or(0));
    for (std::size_t c = 0; c < D; ++c) {
      compare(one.value[c], other.value[c]);
      if (one.left) compare((*one.left)[c], (*other.left)[c]);
    }
    far = std::max({far, distance<D>(one.in, other.in), distance<D>(one.out, other.out)});
  }
  for (std::size_t c = 0; c < D; ++c) {
    compare(a.before.slope[c], b.before.slope[c]);
    compare(a.after.slope[c], b.after.slope[c]);
  }
  if (a.loop) {
    compare(a.loop->from, b.loop->from);
    compare(a.loop->to, b.loop->to);
    for (std::size_t c = 0; c < D; ++c) compare(a.loop->offset[c], b.loop->offset[c]);
  }
  return far;
}

// `scaled_keys` are the scaled curve: see the tests of the timeline.
template <int D>
void check_all_keys(std::uint64_t seed) {
  Whim whim(seed);
  int scaled = 0;
  for (int round = 0; round < rounds(300); ++round) {
    const CurveKeys<D> keys = some_keys<D>(whim);
    const Scaling<D> scaling = some_scaling<D>(whim);
    Animated<D> channel(keys);
    const std::string text = channel.text();
    const auto all = all_of(keys.keys.size());
    CAPTURE(D, round, text);
    REQUIRE(channel.scale(all, {.keys = {}, .value = {3}, .value_factor = {1}}));
    REQUIRE(channel.text() == text);
    if (!channel.scale(all, operation_of(scaling))) {
      INFO(channel.message());
      REQUIRE(false);
    }
    ++scaled;
    REQUIRE(channel.keys() == written(scaled_keys(keys, scaling)));
    if (scaling.value_factor[0] == 0) continue;
    Scaling<D> back = scaling;
    back.time_factor = 1 / scaling.time_factor;
    for (double& factor : back.value_factor) factor = 1 / factor;
    REQUIRE(channel.scale(all, operation_of(back)));
    // Numbers to 100, pivots to 20, factors down to a hundredth: their rounding.
    const double least = std::fabs(scaling.value_factor[0]);
    REQUIRE(distance(channel.keys(), keys) <= 1e-12 / std::min(least, 1.0));
  }
  CHECK(scaled == rounds(300));
}

TEST_CASE("all keys scaled are the scaled curve, and scaled back the first", "[document]") {
  check_all_keys<1>(21);
  check_all_keys<3>(22);
}

template <int D>
void check_some_keys(std::uint64_t seed) {
  Whim whim(seed);
  int scaled = 0, refused = 0;
  for (int round = 0; round < rounds(300); ++round) {
    const CurveKeys<D> keys = some_keys<D>(whim);
    Scaling<D> scaling = some_scaling<D>(whim);
    if (whim.once_in(2)) scaling.time_factor = 1;
    std::vector<std::size_t> some;
    for (std::size_t k = 0; k < keys.keys.size(); ++k)
      if (whim.once_in(2)) some.push_back(k);
    if (some.size() == keys.keys.size()) continue;
    Animated<D> channel(keys);
    CAPTURE(D, round, channel.text());
    if (!channel.scale(some, operation_of(scaling))) {
      // A loop does not begin at a key that has passed others.
      INFO(channel.message());
      REQUIRE(keys.loop);
      ++refused;
      continue;
    }
    ++scaled;
    const CurveKeys<D> now = channel.keys();
    const CurveKeys<D> target = written(scaled_keys(keys, scaling));
    const Curve<D> curve = Curve<D>::make(now).value();
    CHECK(now.before == keys.before);
    CHECK(now.after == keys.after);
    for (std::size_t k = 0; k < keys.keys.size(); ++k) {
      const bool is_scaled = std::ranges::binary_search(some, k);
      const bool is_next_scaled = std::ranges::binary_search(some, k + 1);
      Key<D> wanted = is_scaled ? target.keys[k] : keys.keys[k];
      if (!(is_scaled && is_next_scaled)) wanted.next = keys.keys[k].next;
      const auto found = std::ranges::find(now.keys, wanted.frame, &Key<D>::frame);
      REQUIRE(found != now.keys.end());
      REQUIRE(*found == wanted);
      if (!now.loop) REQUIRE(curve.value(wanted.frame) == wanted.value);
    }
  }
  CHECK(scaled > rounds(150));
  CHECK(refused < scaled);
}

TEST_CASE("of some keys that are scaled the others stay", "[document]") {
  check_some_keys<1>(23);
  check_some_keys<3>(24);
}

TEST_CASE("a loop goes with the keys at its ends", "[document]") {
  CurveKeys<1> keys{.keys = {key(0, 0), key(4, 1), key(10, 3)}};
  keys.loop = Loop<1>{.from = 0, .to = 10, .after = 1, .offset = {2}};
  Animated<1> channel(keys);
  REQUIRE(channel.scale({2}, {.keys = {}, .frame = 4, .time_factor = 2, .value_factor = {2}}));
  CHECK(channel.keys().loop == Loop<1>{.from = 0, .to = 16, .after = 1, .offset = {2}});
  REQUIRE(channel.scale({0, 1, 2}, {.keys = {}, .frame = 16, .time_factor = 0.4, .step = 1}));
  // To 9.6, 11.2 and 16.
  CHECK(channel.keys().loop == Loop<1>{.from = 10, .to = 16, .after = 1, .offset = {2}});
}

TEST_CASE("new frames and numbers of scaled keys are rounded, and no others", "[document]") {
  CurveKeys<3> keys{.keys = {{.frame = 0, .value = {0.123456, 1, 3}},
                             {.frame = 4, .value = {1, 0.123456, 2}},
                             {.frame = 9, .value = {3.14159, 1, 1}}}};
  keys.keys[1].out = {.kind = Tangent<3>::Kind::Slope, .slope = {0.98765, 0.98765, 0}};
  keys.keys[1].next.kind = Interpolation::Kind::Bezier;
  Animated<3> channel(keys);
  REQUIRE(channel.scale({1, 2}, {.keys = {},
                                 .time_factor = 1.0 / 3,
                                 .value_factor = {1.0 / 3, 1, 1},
                                 .step = 0.1,
                                 .digits = 2}));
  const CurveKeys<3> now = channel.keys();
  CHECK(now.keys[0] == written(keys).keys[0]);
  CHECK(now.keys[1].frame == 1.3);
  CHECK(now.keys[1].value == Value<3>{0.33, 0.123456, 2});
  CHECK(now.keys[1].out.slope == Value<3>{0.98765, 3, 0});
  CHECK(now.keys[2].frame == 3);
  CHECK(now.keys[2].value == Value<3>{1, 1, 1});
}

TEST_CASE("one amplitude of several components is not scaled by several factors", "[document]") {
  CurveKeys<3> keys;
  keys.keys = {{.frame = 0}, {.frame = 5, .value = {1, 1, 1}}, {.frame = 9}};
  keys.keys[0].next = of_ease(Ease::Elastic, EaseSide::Out);
  keys.keys[0].next.amplitude = 2;
  Animated<3> channel(keys);
  const edit::ScaleKeys uneven{.keys = {}, .value_factor = {1, 2, 1}};
  REQUIRE_FALSE(channel.scale({0, 1}, uneven));
  CHECK(channel.message() ==
        "f.center: the elastic segment behind frame 0 has one amplitude for all components; their "
        "value factors must be of the same size");
  CHECK(channel.scale({1, 2}, uneven));
  CHECK(channel.scale({0, 1}, {.keys = {}, .value_factor = {-3, 3, 3}}));
  CHECK(channel.keys().keys[0].next.amplitude == 6);
}

}  // namespace
}  // namespace pliant::testing
