#pragma once

#include <string>
#include <vector>

#include "pliant/timeline/exact_sum.hpp"
#include "pliant/timeline/key.hpp"
#include "pliant/timeline/overshoot.hpp"

namespace pliant::timeline {

/// A tangent as it shapes one segment: how far it extends into it, and how much it rises there.
template <int D>
struct SegmentHandle {
  double length = 0;       ///< [frames], >= 0
  bool is_third = false;   ///< exactly a third of the segment, even if `length` is rounded
  bool is_vector = false;  ///< given as a vector: `rise` is used, not `slope`
  Value<D> slope = {};     ///< [unit/frame]
  Value<D> rise = {};      ///< over `length` [unit]

  /// Three times the handle: the derivative of the Bézier cubic at its end, in time and in value.
  Pair frame_rate(Pair span) const { return is_third ? span : exact_product(3, length); }
  Value<D> value_rate(double span) const {
    Value<D> rate;
    for (int c = 0; c < D; ++c) {
      if (is_vector) {
        rate[c] = 3 * rise[c];
      } else {
        rate[c] = is_third ? slope[c] * span : 3 * (slope[c] * length);
      }
    }
    return rate;
  }

  /// The same handle with another length: a numeric slope stays the same, a vector is scaled as a
  /// whole (one of length 0 keeps its rise).
  SegmentHandle with_length(double new_length) const {
    SegmentHandle handle = *this;
    handle.length = new_length;
    handle.is_third = false;
    if (length > 0) {
      for (double& each : handle.rise) each *= new_length / length;
    }
    return handle;
  }
};

/// The handle of a tangent in a segment of `span` frames. Appends one line to `changes` for each
/// change that the rules make.
template <int D>
SegmentHandle<D> segment_handle_of(const Tangent<D>& tangent, const Value<D>& slope, double span,
                                   bool is_out, std::vector<std::string>& changes);

extern template SegmentHandle<1> segment_handle_of<1>(const Tangent<1>&, const Value<1>&, double,
                                                      bool, std::vector<std::string>&);
extern template SegmentHandle<3> segment_handle_of<3>(const Tangent<3>&, const Value<3>&, double,
                                                      bool, std::vector<std::string>&);

}  // namespace pliant::timeline
