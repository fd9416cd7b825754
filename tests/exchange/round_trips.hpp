#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "pliant/exchange/curve_file.hpp"
#include "support/catch.hpp"
#include "timeline/authoring.hpp"

// Comparing curves before and after they went through a file.

namespace pliant::testing {

inline double range_of(const Curve<1>& curve, double first, double last) {
  const ValueRange<1> range = curve.range(first, last);
  return range.high[0] - range.low[0];
}

/// How much curve b may differ from a: each of its values must be one that a has within `frames` of
/// it, up to `value`.
struct Slack {
  double frames = 0;
  double value = 0;
};

/// How far a value is from those that a curve has near a frame.
inline double distance_at(const Curve<1>& curve, double frame, double value, const Slack& slack) {
  const ValueRange<1> near = curve.range(frame - slack.frames, frame + slack.frames);
  const Value<1> left = curve.left_value(frame - slack.frames);
  const Value<1> right = curve.left_value(frame + slack.frames);
  const double low = std::min({near.low[0], left[0], right[0]});
  const double high = std::max({near.high[0], left[0], right[0]});
  return std::max({0.0, low - value, value - high});
}

/// The largest such distance beyond `slack.value`, over many frames from `first` to `last`, those
/// of keys and beside them among them; 0: the curves agree.
inline double disagreement(const Curve<1>& a, const Curve<1>& b, double first, double last,
                           const Slack& slack) {
  std::vector<double> frames;
  constexpr int count = 400;
  for (int k = 0; k <= count; ++k) frames.push_back(first + (last - first) * k / count);
  for (const Key<1>& key : a.keys().keys)
    for (const double shift : {0.0, -1e-3, 1e-3, -0.3, 0.3}) frames.push_back(key.frame + shift);
  double worst = 0;
  for (const double frame : frames) {
    if (frame < first || frame > last) continue;
    const double there = distance_at(a, frame, b.value(frame)[0], slack);
    const double off = there - slack.value;
    if (off > worst) {
      worst = off;
      UNSCOPED_INFO(
          fmt::format("frame {}: {} and {}", frame, a.value(frame)[0], b.value(frame)[0]));
    }
  }
  return worst;
}

inline bool is_exact(const std::vector<CurveLoss>& losses) {
  return std::all_of(losses.begin(), losses.end(),
                     [](const CurveLoss& loss) { return loss.is_exact; });
}

/// Whether a curve goes through a format, as told.
inline void check_round_trip(const Curve<1>& curve, CurveFormat format, double first, double last,
                             double tolerance, double gap) {
  CurveWriting writing;
  writing.first = first;
  writing.last = last;
  writing.tolerance = tolerance;
  const auto text = write_curves({{"poke.magnitude", curve}}, format, writing);
  // Keys that are too many or too close for the format.
  for (const char* rule :
       {"at most 500000", "more than 500000", "have one time in single precision"})
    if (!text && text.error().message.find(rule) != std::string::npos) return;
  INFO((text ? "" : text.error().message));
  REQUIRE(text.has_value());
  const auto file = parse_curves(text->bytes, format, "file", {});
  INFO((file ? "" : file.error().message));
  REQUIRE(file.has_value());
  const auto& keys = curve.keys().keys;
  const double from = std::min(first, keys.front().frame), to = std::max(last, keys.back().frame);
  const double range = range_of(curve, from, to) + 1e-300;
  std::string told;
  for (const CurveLoss& loss : text->losses) told += loss.message + "\n";
  CAPTURE(told, text->bytes);
  REQUIRE(file->curves.size() == (format == CurveFormat::Gltf ? 3 : 1));
  const auto back = Curve<1>::make(file->curves[0].keys);
  REQUIRE(back.has_value());
  const bool is_single = format == CurveFormat::Gltf;
  const double digits = is_single ? 2e-6 : 1e-12;
  const double place = std::max({1.0, std::fabs(from), std::fabs(to)});
  const bool exact = is_exact(text->losses);
  const Slack slack{(exact ? 0 : gap) + digits * place,
                    (exact ? 0 : 1.0 * tolerance * range) + digits * (range + is_single * 20)};
  CHECK(disagreement(curve, *back, from, to, slack) == 0);
}

}  // namespace pliant::testing
