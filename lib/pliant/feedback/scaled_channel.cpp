#include "pliant/feedback/scaled_channel.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/core/text.hpp"
#include "pliant/timeline/curve_numbers.hpp"

namespace pliant {

double rounded(double number, double range) {
  if (number == 0 || !std::isfinite(number)) return number;
  const auto place = [](double of) { return static_cast<int>(std::floor(std::log10(of))); };
  const int own = place(std::abs(number));
  const int finest = range > 0 ? std::min(own, place(range)) : own;
  const int digits = std::clamp(3 + own - finest, 3, 16);
  return with_digits(number, digits + 1);
}

Result<Channel<1>> scaled(const Channel<1>& channel, double factor) {
  PLIANT_EXPECTS(factor > 0);
  if (!channel.is_animated()) {
    return Channel<1>(rounded(factor * channel.at(0)[0]));
  }
  CurveKeys<1> keys = channel.curve().keys();
  const auto [low, high] =
      std::minmax_element(keys.keys.begin(), keys.keys.end(),
                          [](const Key<1>& a, const Key<1>& b) { return a.value[0] < b.value[0]; });
  const double range = factor * (high->value[0] - low->value[0]);
  for_each_number(keys, [&](double& number) { number = rounded(factor * number, range); });
  auto curve = Curve<1>::make(std::move(keys));
  if (!curve) return invalid(fmt::format("its keys times {:g}: {}", factor, curve.error().message));
  return Channel<1>(*std::move(curve));
}

double farthest_value(const Channel<1>& channel) {
  if (!channel.is_animated()) return channel.at(0)[0];
  double farthest = 0;
  for (const Key<1>& key : channel.curve().keys().keys) {
    if (std::abs(key.value[0]) > std::abs(farthest)) farthest = key.value[0];
  }
  return farthest;
}

}  // namespace pliant
