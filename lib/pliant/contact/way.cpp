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

std::optional<Contact> first_contact_of_convex(const Kept& from, const Kept& to, const Vector3d& x0,
                                               const Vector3d& x1, double slack) {
  const Way way(from, to, x0, x1);
  const Way::Moment begin = way.at(0);
  if (!way.first_at(-slack, begin)) {
    // The end itself may lie so deep that the way to the level ends where rounding lets it.
    if (!(way.at(1).near.distance < -slack)) return std::nullopt;
  }
  const auto first = way.first_at(0, begin).value_or(way.at(1));
  return Contact{first.near.normal, first.x, support(to.solid, first.near.normal)};
}

// A node's way to a mesh. It is followed from one moment to the next: what is outside, farther than
// the slack, goes on to where it is not; what is as near as the slack goes on to where the triangle
// that is nearest is farther than that. Each triangle that keeps its shape is left only once.
class WayToMesh {
 public:
  WayToMesh(const MeshWay& mesh, const Kept& from, const Kept& to, const Vector3d& x0,
            const Vector3d& x1, double slack)
      : mesh_(mesh),
        offset0_(from.offset),
        offset1_(to.offset),
        x0_(x0),
        x1_(x1),
        slack_(std::max(slack, 1e-13 * mesh.diagonal())) {}

  struct Moment {
    double t = 0;
    double gap = 0;
    MeshNearness near = {};
  };

  Moment at(double t) {
    Moment moment{t, 0, mesh_.nearness(x_at(t), t, last_)};
    last_ = moment.near.foot.triangle;
    moment.gap = moment.near.distance - offset_at(t);
    return moment;
  }

  Vector3d x_at(double t) const { return t < 1 ? Vector3d(x0_ + t * (x1_ - x0_)) : x1_; }

  std::optional<Moment> first(const MeshBegin& known) {
    last_ = known.near;
    Moment begin{0, known.distance.value_or(0) - offset0_, {}};
    begin.near.foot.triangle = known.near;
    // The normal is of use only where it is near.
    if (!known.distance || !(begin.gap > 2 * slack_)) begin = at(0);
    if (begin.gap < -slack_) return begin;
    if (begin.gap <= 0 && at(1).gap < -slack_) return begin;
    last_ = begin.near.foot.triangle;
    // Below twice the slack an offset counts as none.
    const double least = 2 * slack_;
    const bool begins_high = offset0_ > least, ends_high = offset1_ > least;
    outside_ = begin;
    if (begins_high == ends_high) return follow(begin, 1, begins_high);
    const double change = (least - offset0_) / (offset1_ - offset0_);
    if (auto found = follow(begin, change, begins_high)) return found;
    return follow(at(change), 1, ends_high);
  }

 private:
  double offset_at(double t) const {
    return offset0_ == offset1_ ? offset0_ : (1 - t) * offset0_ + t * offset1_;
  }

  MeshWay::Mover mover(double beyond) const {
    return {x0_, x1_, offset0_ + beyond, offset1_ + beyond};
  }

  std::optional<Moment> follow(Moment now, double end, bool is_high) {
    constexpr int most_turns = 2000;
    const double band = slack_ * (1 + 1e-6);
    for (int turn = 0; turn < most_turns; ++turn) {
      if (now.gap < -slack_) return crossing(now);
      if (now.gap > 0 && (outside_.gap > 0 || now.t == 0)) outside_ = now;
      if (now.t >= end) return std::nullopt;
      std::optional<double> next;
      if (is_high) {
        const auto meets = mesh_.meeting(mover(-slack_), now.t, end);
        if (!meets) return at_end(end);
        last_ = meets->triangle;
        return crossing(at(meets->t));
      }
      if (now.gap > band) {
        const auto meets = mesh_.meeting(mover(slack_), now.t, end);
        if (!meets && !mesh_.moves()) return std::nullopt;
        if (!meets) return at_end(end);
        last_ = meets->triangle;
        next = meets->t;
        // Where rounding lets it go no farther it counts as near.
        if (!(*next > now.t)) next = mesh_.parting(mover(band), meets->triangle, now.t, end);
      } else {
        next = mesh_.parting(mover(band), now.near.foot.triangle, now.t, end);
      }
      if (!next) return at_end(end);
      if (!(*next > now.t)) next = std::min(end, now.t + 1e-9);
      now = at(*next);
    }
    return at_end(end);
  }

  std::optional<Moment> at_end(double end) {
    const Moment last = at(end);
    return last.gap < -slack_ ? std::optional(crossing(last)) : std::nullopt;
  }

  // Where it came in, on the way from where it was outside to where it is inside.
  Moment crossing(const Moment& inside) {
    if (!(outside_.gap > 0)) return outside_;
    // A flat face is met in one step: the distance is linear there. Halving makes it end.
    constexpr int most_turns = 100;
    const double enough = 1e-6 * slack_;
    Moment low = outside_, high = inside;
    double low_weight = low.gap, high_weight = high.gap;
    for (int turn = 0; turn < most_turns && high.t > low.t; ++turn) {
      double t = low.t + (high.t - low.t) * (low_weight / (low_weight - high_weight));
      if (turn % 3 == 2) t = (low.t + high.t) / 2;
      if (!(t > low.t && t < high.t)) break;
      Moment middle = at(t);
      if (std::abs(middle.gap) <= enough) return middle;
      if (middle.gap > 0) {
        low = middle;
        low_weight = low.gap;
        high_weight /= 2;
      } else {
        high = middle;
        high_weight = high.gap;
        low_weight /= 2;
      }
    }
    return high;
  }

  const MeshWay& mesh_;
  double offset0_, offset1_;
  Vector3d x0_, x1_;
  double slack_;
  int last_ = -1;   // the triangle that was nearest
  Moment outside_;  // the last moment outside; else the beginning
};

MeshWay way_of(const Kept& from, const Kept& to) {
  return {*std::get<MeshSolid>(from.solid).posed, *std::get<MeshSolid>(to.solid).posed};
}

// The mesh carries the node by the place that was touched.
Contact contact_with(const MeshWay& way, const MeshNearness& near, const Vector3d& x, double t) {
  const Vector3d touched = way.place(near.foot, t), at_end = way.place(near.foot, 1);
  return {near.normal, way.moves() ? Vector3d(x + at_end - touched) : x,
          dot_of(near.normal, at_end)};
}

}  // namespace

Nearness nearness(const Kept& kept, const Vector3d& x) {
  Nearness near = nearness(kept.solid, x);
  near.distance -= kept.offset;
  return near;
}

std::optional<Contact> first_contact(const Kept& from, const Kept& to, const Vector3d& x0,
                                     const Vector3d& x1, double slack, const MeshBegin& begin) {
  if (!std::holds_alternative<MeshSolid>(from.solid))
    return first_contact_of_convex(from, to, x0, x1, slack);
  const MeshWay mesh = way_of(from, to);
  WayToMesh way(mesh, from, to, x0, x1, slack);
  const auto first = way.first(begin);
  if (!first) return std::nullopt;
  return contact_with(mesh, first->near, way.x_at(first->t), first->t);
}

std::optional<Contact> lying_contact(const Kept& from, const Kept& to, const Vector3d& x,
                                     double near) {
  if (!std::holds_alternative<MeshSolid>(from.solid)) {
    const Nearness nearest = nearness(from, x);
    if (!(std::abs(nearest.distance) <= near)) return std::nullopt;
    return Contact{nearest.normal, x - nearest.distance * nearest.normal,
                   support(to.solid, nearest.normal)};
  }
  const MeshWay mesh = way_of(from, to);
  const MeshNearness nearest = mesh.nearness(x, 0);
  const double distance = nearest.distance - from.offset;
  if (!(std::abs(distance) <= near)) return std::nullopt;
  return contact_with(mesh, nearest, x - distance * nearest.normal, 0);
}

}  // namespace pliant
