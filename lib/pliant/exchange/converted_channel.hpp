#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pliant/exchange/convert.hpp"
#include "pliant/exchange/curve_file.hpp"

namespace pliant::exchange {

/// One component of a channel that a format can hold.
struct ConvertedComponent {
  int component = -1;  ///< -1: the channel has only one
  Segments segments;
};

/// A channel that a format can hold.
struct ConvertedChannel {
  std::string thing;      ///< `poke` of `poke.center`
  std::string attribute;  ///< `center`
  std::vector<ConvertedComponent> components;
};

/// The deviation that is allowed, for each component: a share of its range over the keys and the
/// wanted frames [unit].
double tolerance_of(const Curve<1>& curve, const CurveWriting& writing);

/// Appends what was lost to `losses`. Errors: those of `convert`, naming the channel.
Result<ConvertedChannel> converted_channel(const ChannelCurve& curve, const Abilities& abilities,
                                           const CurveWriting& writing,
                                           std::vector<CurveLoss>& losses);

}  // namespace pliant::exchange
