#include "pliant/timeline/arms.hpp"

#include <cmath>

#include "pliant/timeline/number_text.hpp"

namespace pliant::timeline {

template <int D>
Arm<D> arm_of(const Tangent<D>& tangent, const Value<D>& slope, double span, bool is_out,
              std::vector<std::string>& changes) {
  const std::string name = is_out ? "out" : "in";
  Arm<D> arm;
  arm.slope = slope;
  if (tangent.kind == Tangent<D>::Kind::Handle) {
    arm.is_vector = true;
    // Both arms point into the segment; an `in` handle points backwards from its key.
    const double direction = is_out ? 1 : -1;
    arm.length = direction * tangent.handle_frames;
    if (arm.length < 0) {
      changes.push_back(name + " handle points backwards in time (" +
                        number_text(tangent.handle_frames) +
                        " frames) and is treated as having no length");
      arm.length = 0;
      return arm;
    }
    arm.length = std::fabs(arm.length);  // no -0
    for (int c = 0; c < D; ++c) arm.rise[c] = direction * tangent.handle_value[c];
    return arm;
  }
  if (!tangent.length) {
    arm.length = span / 3;
    arm.is_third = true;
    return arm;
  }
  arm.length = *tangent.length;
  if (arm.length < 0) {
    changes.push_back(name + " tangent has the negative length " + number_text(arm.length) +
                      " and is treated as having no length");
    arm.length = 0;
  }
  arm.length = std::fabs(arm.length);
  return arm;
}

template Arm<1> arm_of<1>(const Tangent<1>&, const Value<1>&, double, bool,
                          std::vector<std::string>&);
template Arm<3> arm_of<3>(const Tangent<3>&, const Value<3>&, double, bool,
                          std::vector<std::string>&);

}  // namespace pliant::timeline
