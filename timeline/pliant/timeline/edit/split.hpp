#pragma once

#include <cstddef>
#include <optional>

#include "pliant/timeline/track.hpp"

namespace pliant::timeline {

/// A handle of a compiled segment; it points into the segment.
template <int D>
struct Handle {
  double frames = 0;    ///< >= 0
  Value<D> value = {};  ///< relative to the key or, on the right, to the segment's end value [unit]

  /// As the `out` tangent of the left key, or as the `in` tangent of the right one.
  Tangent<D> as_tangent(bool is_out) const;
};

/// The two handles of a segment.
template <int D>
struct Handles {
  Handle<D> start;
  Handle<D> end;
};

/// The handles of segment k as evaluated, after any correction. Requires: no easing.
template <int D>
Handles<D> handles_of(const Track<D>& track, std::size_t k);

/// The handles left and right of a frame inside segment k, by de Casteljau's construction.
/// Requires: no easing; start < frame < end.
template <int D>
struct Split {
  Handles<D> left;
  Handles<D> right;
};
template <int D>
Split<D> split(const Track<D>& track, std::size_t k, double frame);

/// The handles of the segment whose halves have the given ones, if there is such a segment: the
/// inverse of `split`. Reads the compiled segments k and k + 1. Requires: no easings.
template <int D>
std::optional<Handles<D>> joined(const Track<D>& track, std::size_t k);

extern template struct Handle<1>;
extern template struct Handle<3>;
extern template Handles<1> handles_of(const Track<1>&, std::size_t);
extern template Handles<3> handles_of(const Track<3>&, std::size_t);
extern template Split<1> split(const Track<1>&, std::size_t, double);
extern template Split<3> split(const Track<3>&, std::size_t, double);
extern template std::optional<Handles<1>> joined(const Track<1>&, std::size_t);
extern template std::optional<Handles<3>> joined(const Track<3>&, std::size_t);

}  // namespace pliant::timeline
