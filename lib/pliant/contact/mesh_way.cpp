#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "pliant/contact/solid_mesh.hpp"
#include "pliant/core/elementary.hpp"

namespace pliant {
namespace {

using Triangle = PosedMesh::Triangle;

constexpr double infinite = std::numeric_limits<double>::infinity();

// A triangle that is lower than this part of its longest side has no normal of its own.
constexpr double least_height = 1e-8;

// What is nearer than this part of the mesh's diagonal counts as the same place where such
// triangles are.
constexpr double one_place = 1e-8;

// A search looks into what may be nearer by this much, so that rounding hides nothing: of a squared
// distance, and of the square of how far apart things are.
constexpr double more = 1.001, rounding = 1e-23;

double squared(const Vector3d& a) { return dot_of(a, a); }

double longest_side(const Triangle& of) {
  return std::max({squared(of[1] - of[0]), squared(of[2] - of[1]), squared(of[0] - of[2])});
}

// Twice its area along its normal; 0 if it has none of its own.
Vector3d area_of(const Triangle& of) {
  const Vector3d area = cross_of(of[1] - of[0], of[2] - of[0]);
  const double longest = longest_side(of) * least_height;
  return squared(area) > longest * longest ? area : Vector3d(0, 0, 0);
}

// The angle between two vectors that are not 0. [rad]
double angle_between(const Vector3d& a, const Vector3d& b) {
  constexpr double half_turn = 3.14159265358979323846;
  const Vector3d one = a / std::sqrt(squared(a)), other = b / std::sqrt(squared(b));
  if (dot_of(one, other) >= 0)
    return 2 * asin_of(std::min(1.0, std::sqrt(squared(one - other)) / 2));
  return half_turn - 2 * asin_of(std::min(1.0, std::sqrt(squared(one + other)) / 2));
}

double angle_at(const Triangle& of, int corner) {
  return angle_between(of[(corner + 1) % 3] - of[corner], of[(corner + 2) % 3] - of[corner]);
}

// The place of a triangle that is closest to another one.
struct Closest {
  double squared = infinite;
  std::array<double, 3> weights = {1, 0, 0};

  void take(double distance, const std::array<double, 3>& of) {
    if (!(distance < squared)) return;
    squared = distance;
    weights = of;
  }
};

// Within it, on its sides or at its corners, whichever is found to be closest: weights of what is
// low are all rounding. Only if it is nearer than `most`.
Closest closest_of(const Triangle& of, const Vector3d& x, double most) {
  Closest closest;
  const Vector3d b = of[1] - of[0], c = of[2] - of[0], way = x - of[0];
  const Vector3d area = area_of(of);
  const double size = squared(area);
  if (size > 0) {
    const double height = dot_of(area, way);
    if (height * height > size * (more * most + rounding * squared(way))) return closest;
    const double share_b = dot_of(cross_of(way, c), area) / size;
    const double share_c = dot_of(cross_of(b, way), area) / size;
    const double rest = 1 - share_b - share_c;
    if (share_b >= 0 && share_c >= 0 && rest >= 0) {
      closest.take(height * height / size, {rest, share_b, share_c});
      return closest;
    }
  }
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const Vector3d side = of[next] - of[k], from = x - of[k];
    const double side_size = squared(side);
    double share = side_size > 0 ? dot_of(from, side) / side_size : 0;
    share = share > 0 ? std::min(share, 1.0) : 0;
    std::array<double, 3> weights = {0, 0, 0};
    weights[k] = 1 - share;
    weights[next] = share;
    closest.take(share < 1 ? squared(from - share * side) : squared(x - of[next]), weights);
  }
  return closest;
}

Vector3d point_between(const Vector3d& a, const Vector3d& b, double t) {
  return (1 - t) * a + t * b;
}

// The part of a way on which all of some linear functions are >= 0.
struct Span {
  double begin, end;

  void keep(double at_begin, double at_end) {  // at t = 0 and 1
    if (at_begin >= 0 && at_end >= 0) return;
    if (at_begin < 0 && at_end < 0) {
      end = -1;
      return;
    }
    const double zero = at_begin / (at_begin - at_end);
    if (at_begin < 0) {
      begin = std::max(begin, zero);
    } else {
      end = std::min(end, zero);
    }
  }
};

}  // namespace

struct MeshWay::Foot {
  int place = -1;  // in the order of the leaves
  int triangle = std::numeric_limits<int>::max();
  double squared = infinite;
  std::array<double, 3> weights = {1, 0, 0};
};

PosedMesh::Triangle MeshWay::triangle_at(int place, double t) const {
  const Triangle& from = from_.at(place);
  if (!moves() || t == 0) return from;
  const Triangle& to = to_.at(place);
  if (t == 1) return to;
  return {point_between(from[0], to[0], t), point_between(from[1], to[1], t),
          point_between(from[2], to[2], t)};
}

PosedMesh::Box MeshWay::box_at(int cluster, double t) const {
  const PosedMesh::Box& from = from_.box(cluster);
  if (!moves()) return from;
  const PosedMesh::Box& to = to_.box(cluster);
  return {point_between(from.low, to.low, t), point_between(from.high, to.high, t)};
}

Vector3d MeshWay::place(const MeshPlace& place, double t) const {
  const Triangle of = triangle_at(from_.mesh().place_of(place.triangle), t);
  return place.weights[0] * of[0] + place.weights[1] * of[1] + place.weights[2] * of[2];
}

void MeshWay::try_triangle(int place, const Vector3d& x, double t, Foot& best) const {
  const Closest closest = closest_of(triangle_at(place, t), x, best.squared);
  const int triangle = from_.mesh().order()[place];
  const bool is_closer = closest.squared < best.squared ||
                         (closest.squared == best.squared && triangle < best.triangle);
  if (!is_closer) return;
  best = {place, triangle, closest.squared, closest.weights};
}

MeshNearness MeshWay::nearness(const Vector3d& x, double t, int near) const {
  Foot best;
  if (near >= 0) try_triangle(from_.mesh().place_of(near), x, t, best);
  const auto& clusters = from_.mesh().clusters();
  struct Open {
    double least;
    int cluster;
  };
  std::array<Open, 64> open;  // the tree is balanced
  std::size_t count = 0;
  const double slack = rounding * (squared(x - from_.box(0).low) + squared(x - from_.box(0).high));
  const auto least_of = [&](int cluster) {
    const PosedMesh::Box box = box_at(cluster, t);
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      const double way = std::max({box.low[k] - x[k], x[k] - box.high[k], 0.0});
      sum += way * way;
    }
    return sum;
  };
  open[count++] = {least_of(0), 0};
  while (count > 0) {
    const auto [least, cluster] = open[--count];
    if (least > more * best.squared + slack) continue;
    const PointTree::Cluster& here = clusters[cluster];
    if (here.is_leaf()) {
      for (int n = here.first; n < here.first + here.count; ++n) try_triangle(n, x, t, best);
      continue;
    }
    Open first{least_of(here.child), here.child}, second{least_of(here.child + 1), here.child + 1};
    if (second.least < first.least) std::swap(first, second);
    open[count++] = second;
    open[count++] = first;
  }
  MeshNearness found;
  if (best.place < 0) {  // squares of these lengths are not finite
    found.distance = infinite;
    return found;
  }
  found.foot = {best.triangle, best.weights};
  const double side = from_.is_mirrored() ? -1 : 1;
  const Triangle of = triangle_at(best.place, t);
  const bool is_within = best.weights[0] > 0 && best.weights[1] > 0 && best.weights[2] > 0;
  if (is_within) {
    const Vector3d area = area_of(of);
    const double size = std::sqrt(squared(area));
    found.normal = side / size * area;
    found.distance = dot_of(found.normal, x - of[0]);
    return found;
  }
  const Vector3d at = best.weights[0] * of[0] + best.weights[1] * of[1] + best.weights[2] * of[2];
  const Vector3d way = x - at;
  const Vector3d normal = side * normal_at(found.foot, at, t);
  const double distance = std::sqrt(best.squared);
  const double sign = dot_of(way, normal) < 0 ? -1 : 1;
  const double size = std::sqrt(squared(normal));
  const double way_size = std::sqrt(squared(way));
  const bool is_apart =
      distance > 1e-9 * from_.diagonal() && way_size > 0 && std::isfinite(way_size);
  found.distance = sign * distance;
  if (is_apart || !(size > 0)) {
    found.normal = way_size > 0 ? Vector3d(sign / way_size * way) : Vector3d(0, 1, 0);
  } else {
    found.normal = normal / size;
  }
  return found;
}

// Of length 1; 0 if the triangle is too low.
Vector3d MeshWay::unit_normal(int triangle, double t) const {
  const Vector3d area = area_of(triangle_at(from_.mesh().place_of(triangle), t));
  const double size = std::sqrt(squared(area));
  return size > 0 ? Vector3d(area / size) : area;
}

// The normals at an edge or a corner, weighted by the angles of their triangles there.
Vector3d MeshWay::normal_at(const MeshPlace& place, const Vector3d& at, double t) const {
  const SolidMesh& mesh = from_.mesh();
  const auto& weights = place.weights;
  const auto zeros = std::ranges::count(weights, 0.0);
  Vector3d sum(0, 0, 0);
  if (zeros < 2) {
    const int apart = weights[0] == 0 ? 0 : weights[1] == 0 ? 1 : 2;  // the corner at no end
    const int other = mesh.neighbour(place.triangle, (apart + 1) % 3);
    const Vector3d a = unit_normal(place.triangle, t), b = unit_normal(other, t);
    if (a.isZero(0) || b.isZero(0)) return gathered_normal(at, t);
    return a + b;
  }
  const int corner = weights[0] != 0 ? 0 : weights[1] != 0 ? 1 : 2;
  for (const int one : mesh.corners_at(mesh.triangles()[place.triangle][corner])) {
    const Vector3d normal = unit_normal(one / 3, t);
    if (normal.isZero(0)) return gathered_normal(at, t);
    sum += angle_at(triangle_at(mesh.place_of(one / 3), t), one % 3) * normal;
  }
  return sum;
}

// The same of all triangles that are not low and lie so near that it is as good as there.
Vector3d MeshWay::gathered_normal(const Vector3d& at, double t) const {
  constexpr double half_turn = 3.14159265358979323846;
  const SolidMesh& mesh = from_.mesh();
  const double near = one_place * from_.diagonal();
  std::vector<int> open = {0}, found;
  while (!open.empty()) {
    const int cluster = open.back();
    open.pop_back();
    const PosedMesh::Box box = box_at(cluster, t);
    bool is_near = true;
    for (int k = 0; k < 3; ++k)
      is_near = is_near && at[k] >= box.low[k] - near && at[k] <= box.high[k] + near;
    if (!is_near) continue;
    const PointTree::Cluster& here = mesh.clusters()[cluster];
    if (here.is_leaf()) {
      for (int n = here.first; n < here.first + here.count; ++n) found.push_back(mesh.order()[n]);
    } else {
      open.push_back(here.child);
      open.push_back(here.child + 1);
    }
  }
  std::ranges::sort(found);
  Vector3d sum(0, 0, 0);
  for (const int triangle : found) {
    const Triangle of = triangle_at(mesh.place_of(triangle), t);
    const Vector3d area = area_of(of);
    if (area.isZero(0)) continue;
    const Closest closest = closest_of(of, at, near * near);
    if (!(closest.squared <= near * near)) continue;
    // Where it is within `near` of a side it is there, and at a corner likewise.
    double weight = 2 * half_turn;
    for (int k = 0; k < 3; ++k) {
      const Vector3d side = of[(k + 1) % 3] - of[k], from = at - of[k];
      if (squared(cross_of(side, from)) <= near * near * squared(side)) weight = half_turn;
    }
    for (int k = 0; k < 3; ++k)
      if (squared(at - of[k]) <= near * near) weight = angle_at(of, k);
    sum += weight / std::sqrt(squared(area)) * area;
  }
  return sum;
}

// The distance to a triangle that only moves as a whole is convex in time, so that Newton's method
// does not pass its first meeting; of one that changes its shape it is at least what it would be,
// less the way by which its corners go apart. What slides along such a one comes hardly nearer in
// this way, and is looked at again and again instead.
std::optional<double> MeshWay::first_within(int place, const Mover& mover, double begin,
                                            double end) const {
  constexpr int most_turns = 60, looks = 256;
  const Vector3d way = mover.x1 - mover.x0;
  const double growth = mover.near1 - mover.near0;
  Vector3d shift = way;
  double change = 0;
  if (moves()) {
    const Triangle &from = from_.at(place), &to = to_.at(place);
    const std::array<Vector3d, 3> ways = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
    const Vector3d mean = (ways[0] + ways[1] + ways[2]) / 3;
    for (const Vector3d& one : ways) change = std::max(change, std::sqrt(squared(one - mean)));
    shift -= mean;
  }
  struct Gap {
    double size;
    Vector3d way;  // from the triangle
  };
  const auto gap_at = [&](double t) {
    const Triangle of = triangle_at(place, t);
    const Vector3d x = mover.x0 + t * way;
    const Closest closest = closest_of(of, x, infinite);
    const auto& weights = closest.weights;
    return Gap{std::sqrt(closest.squared) - (mover.near0 + t * growth),
               x - (weights[0] * of[0] + weights[1] * of[1] + weights[2] * of[2])};
  };
  double t = begin;
  for (int turn = 0; turn < most_turns; ++turn) {
    const Gap gap = gap_at(t);
    if (!(gap.size > 0)) return t;
    const double apart = std::sqrt(squared(gap.way));
    const double approach = apart > 0 ? dot_of(gap.way, shift) / apart : 0;
    const double slope = approach - change - growth;
    if (!(slope < 0)) return std::nullopt;
    const double next = t + gap.size / -slope;
    if (next > end) return std::nullopt;
    if (!(next > t)) return t;
    t = next;
  }
  if (!(change > 0)) return t;
  Gap before = gap_at(t);
  for (int look = 1; look <= looks; ++look) {
    const double next = look == looks ? end : t + (end - t) / (looks + 1 - look);
    if (!(next > t)) return std::nullopt;
    const auto is_there = [&](const Gap& gap) {
      return !(gap.size > 0) || dot_of(gap.way, before.way) < 0;
    };
    const Gap gap = gap_at(next);
    if (is_there(gap)) {
      double low = t, high = next;
      for (int halving = 0; halving < 60; ++halving) {
        const double middle = (low + high) / 2;
        (is_there(gap_at(middle)) ? high : low) = middle;
      }
      return high;
    }
    before = gap;
    t = next;
  }
  return std::nullopt;
}

std::optional<MeshWay::Meeting> MeshWay::meeting(const Mover& mover, double begin,
                                                 double end) const {
  const auto& clusters = from_.mesh().clusters();
  const double pad = 1e-12 * (from_.diagonal() + std::sqrt(squared(mover.x1 - mover.x0)) +
                              std::sqrt(squared(mover.x0 - from_.box(0).low)));
  const auto span_of = [&](int cluster) {
    const PosedMesh::Box &from = from_.box(cluster), &to = to_.box(cluster);
    Span span{begin, end};
    for (int k = 0; k < 3; ++k) {
      span.keep(mover.x0[k] - from.low[k] + mover.near0 + pad,
                mover.x1[k] - to.low[k] + mover.near1 + pad);
      span.keep(from.high[k] - mover.x0[k] + mover.near0 + pad,
                to.high[k] - mover.x1[k] + mover.near1 + pad);
    }
    return span;
  };
  std::optional<Meeting> first;
  struct Open {
    Span span;
    int cluster;
  };
  // What rounding leaves of a moment.
  constexpr double early = 1e-13;
  std::array<Open, 64> open;
  std::size_t count = 0;
  const auto add = [&](const Span& span, int cluster) {
    if (span.begin <= span.end + early) open[count++] = {span, cluster};
  };
  add(span_of(0), 0);
  while (count > 0) {
    const auto [span, cluster] = open[--count];
    const double last = first ? first->t : end;
    if (span.begin - early > last) continue;
    const PointTree::Cluster& here = clusters[cluster];
    if (!here.is_leaf()) {
      const Span one = span_of(here.child), other = span_of(here.child + 1);
      if (one.begin <= other.begin) {
        add(other, here.child + 1);
        add(one, here.child);
      } else {
        add(one, here.child);
        add(other, here.child + 1);
      }
      continue;
    }
    for (int n = here.first; n < here.first + here.count; ++n) {
      const auto t = first_within(n, mover, begin, first ? first->t : end);
      if (!t) continue;
      const int triangle = from_.mesh().order()[n];
      if (!first || *t < first->t || (*t == first->t && triangle < first->triangle))
        first = Meeting{*t, triangle};
    }
  }
  return first;
}

std::optional<double> MeshWay::parting(const Mover& mover, int triangle, double begin,
                                       double end) const {
  const int place = from_.mesh().place_of(triangle);
  const auto is_within = [&](double t) {
    const double near = mover.near0 + t * (mover.near1 - mover.near0);
    const Closest closest =
        closest_of(triangle_at(place, t), mover.x0 + t * (mover.x1 - mover.x0), infinite);
    return closest.squared <= near * near;
  };
  // It stays within its distance on one part of the way, if the triangle keeps its shape; otherwise
  // it is looked at again and again.
  const int looks = moves() ? 64 : 1;
  double low = begin, high = end;
  bool parts = false;
  for (int look = 1; look <= looks && !parts; ++look) {
    high = look == looks ? end : begin + (end - begin) * look / looks;
    parts = !is_within(high);
    if (!parts) low = high;
  }
  if (!parts) return std::nullopt;
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = (low + high) / 2;
    if (!(middle > low) || !(middle < high)) break;
    (is_within(middle) ? low : high) = middle;
  }
  return high;
}

}  // namespace pliant
