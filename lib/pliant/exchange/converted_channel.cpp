#include "pliant/exchange/converted_channel.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/exchange/curve_names.hpp"

namespace pliant::exchange {

double tolerance_of(const Curve<1>& curve, const CurveWriting& writing) {
  const auto& keys = curve.keys().keys;
  const ValueRange<1> range = curve.range(std::min(writing.first, keys.front().frame),
                                          std::max(writing.last, keys.back().frame));
  return writing.tolerance * (range.high[0] - range.low[0]);
}

Result<ConvertedChannel> converted_channel(const ChannelCurve& curve, const Abilities& abilities,
                                           const CurveWriting& writing,
                                           std::vector<CurveLoss>& losses) {
  const auto [thing, attribute] = split_channel(curve.channel);
  ConvertedChannel channel{thing, attribute, {}};
  const auto add = [&](const Curve<1>& part, int component) -> Result<void> {
    const std::string name = curve.channel + component_suffix(component);
    auto converted = convert(segments_of(part), abilities, tolerance_of(part, writing),
                             {writing.first, writing.last}, writing.should_stop);
    if (!converted && converted.error().code == ErrorCode::Interrupted)
      return fail(converted.error());
    if (!converted) {
      return fail(converted.error().code, fmt::format("{}: {}", name, converted.error().message));
    }
    for (Loss& loss : converted->losses)
      losses.push_back({name, std::move(loss.message), loss.is_exact});
    channel.components.push_back({component, std::move(converted->segments)});
    return {};
  };
  if (const auto* number = std::get_if<Curve<1>>(&curve.curve)) {
    if (auto added = add(*number, -1); !added) return fail(added.error());
    return channel;
  }
  for (int c = 0; c < 3; ++c) {
    const auto part = Curve<1>::make(component_of(std::get<Curve<3>>(curve.curve).keys(), c));
    PLIANT_EXPECTS(part.has_value());  // it is a part of a curve
    if (auto added = add(*part, c); !added) return fail(added.error());
  }
  return channel;
}

}  // namespace pliant::exchange
