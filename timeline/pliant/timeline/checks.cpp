#include "pliant/timeline/checks.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "pliant/timeline/easing.hpp"
#include "pliant/timeline/number_text.hpp"

namespace pliant::timeline {

namespace {

/// Checks one number after the other and remembers the first that breaks a rule.
class Checker {
 public:
  void at_key(std::size_t key) { key_ = key; }

  void number(std::string_view name, double number) {
    if (!std::isfinite(number)) {
      fail(std::string(name) + " is " + number_text(number) + "; it must be a finite number");
    } else if (std::fabs(number) > largest_number) {
      fail(std::string(name) + " is " + number_text(number) + "; its size must not exceed " +
           number_text(largest_number));
    }
  }

  template <std::size_t N>
  void numbers(std::string_view name, const std::array<double, N>& numbers) {
    for (const double each : numbers) number(name, each);
  }

  /// `message()`: why it does not hold; asked only then, since there are many keys.
  template <class Message>
  void rule(bool holds, const Message& message) {
    if (!holds) fail(message());
  }

  std::optional<Complaint> error() const { return error_; }

 private:
  void fail(std::string message) {
    if (!error_) error_ = Complaint{key_, std::move(message)};
  }

  std::size_t key_ = 0;
  std::optional<Complaint> error_;
};

template <int D>
void check_tangent(const std::string& side, const Tangent<D>& tangent, Checker& check) {
  if (tangent.kind == Tangent<D>::Kind::Handle) {
    check.number("time of the " + side + " handle", tangent.handle_frames);
    check.numbers("value of the " + side + " handle", tangent.handle_value);
    return;
  }
  if (tangent.kind == Tangent<D>::Kind::Slope) {
    check.numbers("slope of the " + side + " tangent", tangent.slope);
  }
  if (tangent.length) check.number("length of the " + side + " tangent", *tangent.length);
}

void check_interpolation(const Interpolation& next, Checker& check) {
  if (next.kind == Interpolation::Kind::CubicBezier) {
    check.numbers("control of cubicBezier", next.control);
    for (const double x : {next.control[0], next.control[2]}) {
      check.rule(x >= 0 && x <= 1, [&] {
        return "control of cubicBezier has x = " + number_text(x) +
               "; x1 and x2 must be from 0 to 1";
      });
    }
  }
  if (next.kind != Interpolation::Kind::Easing) return;
  if (next.ease == Ease::Back && next.back) check.number("back", *next.back);
  if (next.ease == Ease::Elastic) {
    if (next.amplitude) check.number("amplitude", *next.amplitude);
    if (next.period) check.number("period", *next.period);
  }
}

template <int D>
void check_extrapolation(const std::string& side, const Extrapolation<D>& outside, Checker& check) {
  using Kind = typename Extrapolation<D>::Kind;
  if (outside.kind == Kind::Slope) check.numbers("slope " + side + " the keys", outside.slope);
  const bool is_loop = outside.kind == Kind::Repeat || outside.kind == Kind::RepeatOffset ||
                       outside.kind == Kind::Mirror;
  if (!is_loop || !outside.count) return;
  const double count = *outside.count;
  check.number("count of copies " + side + " the keys", count);
  check.rule(count >= 1 && count == std::floor(count), [&] {
    return "count of copies " + side + " the keys is " + number_text(count) +
           "; it must be a whole number of at least 1";
  });
}

template <int D>
void check_loop(const CurveKeys<D>& keys, Checker& check) {
  const Loop<D>& loop = *keys.loop;
  check.number("from of the loop", loop.from);
  check.number("to of the loop", loop.to);
  check.numbers("offset of the loop", loop.offset);
  check.rule(std::any_of(keys.keys.begin(), keys.keys.end(),
                         [&](const Key<D>& key) { return key.frame == loop.from; }),
             [&] {
               return "loop starts from frame " + number_text(loop.from) +
                      "; it must be the frame of a key";
             });
  check.rule(loop.to > loop.from, [&] {
    return "loop ends at frame " + number_text(loop.to) + "; it must end after frame " +
           number_text(loop.from) + ", where it starts";
  });
  check.rule(loop.before >= 0 && loop.after >= 0, [&] {
    return "loop has " + std::to_string(std::min(loop.before, loop.after)) +
           " copies on one side; the number must not be negative";
  });
}

}  // namespace

template <int D>
std::optional<Complaint> broken_rule(const CurveKeys<D>& keys) {
  Checker check;
  check.rule(!keys.keys.empty(), [] { return "the curve has no keys; it must have at least one"; });
  for (std::size_t k = 0; k < keys.keys.size() && !check.error(); ++k) {
    const Key<D>& key = keys.keys[k];
    check.at_key(k);
    check.number("frame", key.frame);
    if (k > 0) {
      const double before = keys.keys[k - 1].frame;
      check.rule(key.frame > before, [&] {
        return "frame " + number_text(key.frame) + " is not after frame " + number_text(before) +
               " of the previous key; frames must strictly increase";
      });
    }
    check.numbers("value", key.value);
    if (key.left) check.numbers("left value", *key.left);
    check_tangent("in", key.in, check);
    check_tangent("out", key.out, check);
    check_interpolation(key.next, check);
    if (k + 1 < keys.keys.size()) {
      check.rule(Easing::is_sound(key.next, keys.keys[k + 1].frame - key.frame), [&] {
        return "period is " + number_text(key.next.period.value_or(0)) +
               "; the segment must not have more than 1e15 periods";
      });
    }
  }
  if (check.error()) return check.error();
  check.at_key(0);
  check_extrapolation("before", keys.before, check);
  if (keys.loop) check_loop(keys, check);
  check.at_key(keys.keys.size() - 1);
  check_extrapolation("after", keys.after, check);
  return check.error();
}

template std::optional<Complaint> broken_rule(const CurveKeys<1>&);
template std::optional<Complaint> broken_rule(const CurveKeys<3>&);

}  // namespace pliant::timeline
