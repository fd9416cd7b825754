#pragma once

#include "pliant/timeline/key.hpp"

namespace pliant {

/// Calls f(number) for each number of a curve that is in the unit of its channel: values, left
/// values and amplitudes, slopes, what handles rise, and the offset of a loop.
template <int D, class F>
void for_each_number(CurveKeys<D>& curve, const F& f) {
  const auto for_all = [&f](Value<D>& value) {
    for (double& number : value) f(number);
  };
  for (Key<D>& key : curve.keys) {
    for_all(key.value);
    if (key.left) for_all(*key.left);
    if (key.next.amplitude) f(*key.next.amplitude);
    for (Tangent<D>* const side : {&key.in, &key.out}) {
      for_all(side->slope);
      for_all(side->handle_value);
    }
  }
  for_all(curve.before.slope);
  for_all(curve.after.slope);
  if (curve.loop) for_all(curve.loop->offset);
}

}  // namespace pliant
