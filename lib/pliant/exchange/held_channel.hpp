#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pliant/exchange/curve_file.hpp"
#include "pliant/exchange/hold.hpp"

namespace pliant::exchange {

/// One component of a channel as a format can hold it.
struct HeldComponent {
  int component = -1;  ///< -1: the channel has only one
  Segments segments;
};

/// A channel as a format can hold it.
struct HeldChannel {
  std::string thing;      ///< `poke` of `poke.center`
  std::string attribute;  ///< `center`
  std::vector<HeldComponent> components;
};

/// The deviation that is allowed, for each component: a share of its range over the keys and the
/// wanted frames [unit].
double tolerance_of(const Curve<1>& curve, const CurveWriting& writing);

/// Appends what was lost to `losses`. Errors: those of `hold`, naming the channel.
Result<HeldChannel> held_channel(const ChannelCurve& curve, const Abilities& abilities,
                                 const CurveWriting& writing, std::vector<CurveLoss>& losses);

}  // namespace pliant::exchange
