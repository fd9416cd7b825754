#include "pliant/contact/way.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {
namespace {

class Way {
 public:
  Way(const Kept& from, const Kept& to, const Vector3d& x0, const Vector3d& x1)
      : from_(from), to_(to), x0_(x0), x1_(x1) {}

  struct Moment {
    double t = 0;
    Vector3d x = {0, 0, 0};
    Nearness near = {};
  };

  Moment at(double t) const {
    Moment moment{t, x0_, nearness(from_, x0_)};
    if (t > 0) {
      moment.x = t < 1 ? Vector3d(x0_ + t * (x1_ - x0_)) : x1_;
      const double offset = (1 - t) * from_.offset + t * to_.offset;
      moment.near = nearness({between(from_.solid, to_.solid, t), offset}, moment.x);
    }
    return moment;
  }

  // How the distance changes: its slope to the right is at least as much.
  double slope(const Vector3d& n) const {
    return dot_of(n, x1_ - x0_) - (support(to_.solid, n) - support(from_.solid, n)) -
           (to_.offset - from_.offset);
  }

  // From `moment` on, the first moment at which the distance is at most `level`; null: there is
  // none up to the end.
  std::optional<Moment> first_at(double level, Moment moment) const {
    constexpr int most_turns = 200;
    for (int turn = 0; turn < most_turns; ++turn) {
      const double left = moment.near.distance - level;
      if (!(left > 0)) return moment;
      const double down = -slope(moment.near.normal);
      if (!(down > 0)) return std::nullopt;
      const double next = moment.t + left / down;
      if (next > 1) return std::nullopt;
      // Rounding lets it go no farther: it is there.
      if (!(next > moment.t)) return moment;
      moment = at(next);
    }
    return moment;
  }

 private:
  const Kept& from_;
  const Kept& to_;
  const Vector3d& x0_;
  const Vector3d& x1_;
};

}  // namespace

Nearness nearness(const Kept& kept, const Vector3d& x) {
  Nearness near = nearness(kept.solid, x);
  near.distance -= kept.offset;
  return near;
}

std::optional<Contact> first_contact(const Kept& from, const Kept& to, const Vector3d& x0,
                                     const Vector3d& x1, double slack) {
  const Way way(from, to, x0, x1);
  const Way::Moment begin = way.at(0);
  if (!way.first_at(-slack, begin)) {
    // The end itself may lie so deep that the way to the level ends where rounding lets it.
    if (!(way.at(1).near.distance < -slack)) return std::nullopt;
  }
  const auto first = way.first_at(0, begin).value_or(way.at(1));
  return Contact{first.near.normal, first.x};
}

}  // namespace pliant
