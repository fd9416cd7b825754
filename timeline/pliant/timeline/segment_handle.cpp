#include "pliant/timeline/segment_handle.hpp"

#include <cmath>

#include "pliant/timeline/number_text.hpp"

namespace pliant::timeline {

template <int D>
SegmentHandle<D> segment_handle_of(const Tangent<D>& tangent, const Value<D>& slope, double span,
                                   bool is_out, std::vector<std::string>& changes) {
  const std::string name = is_out ? "out" : "in";
  SegmentHandle<D> handle;
  handle.slope = slope;
  if (tangent.kind == Tangent<D>::Kind::Handle) {
    handle.is_vector = true;
    // Both handles point into the segment; an `in` handle points backwards from its key.
    const double direction = is_out ? 1 : -1;
    handle.length = direction * tangent.handle_frames;
    if (handle.length < 0) {
      changes.push_back(name + " handle points backwards in time (" +
                        number_text(tangent.handle_frames) +
                        " frames) and is treated as having no length");
      handle.length = 0;
      return handle;
    }
    handle.length = std::fabs(handle.length);  // no -0
    for (int c = 0; c < D; ++c) handle.rise[c] = direction * tangent.handle_value[c];
    return handle;
  }
  if (!tangent.length) {
    handle.length = span / 3;
    handle.is_third = true;
    return handle;
  }
  handle.length = *tangent.length;
  if (handle.length < 0) {
    changes.push_back(name + " tangent has the negative length " + number_text(handle.length) +
                      " and is treated as having no length");
    handle.length = 0;
  }
  handle.length = std::fabs(handle.length);
  return handle;
}

template SegmentHandle<1> segment_handle_of<1>(const Tangent<1>&, const Value<1>&, double, bool,
                                               std::vector<std::string>&);
template SegmentHandle<3> segment_handle_of<3>(const Tangent<3>&, const Value<3>&, double, bool,
                                               std::vector<std::string>&);

}  // namespace pliant::timeline
