#include "pliant/mesh/triangles/polygon_sweep.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <set>
#include <tuple>

namespace pliant {
namespace {

// A line sweeps over the corners, by x and then y. It crosses the inside of the polygon in strips,
// each between two edges. The chain of a strip leads from the left end of the lower edge to that of
// the upper one, along the triangles made so far; right of it, up to the line, there is no corner.
// From its rightmost corner to both its ends, a chain has no corner that a triangle could cut off.
class PolygonSweep {
 public:
  explicit PolygonSweep(std::span<const Eigen::Vector2d> points)
      : points_(points),
        ranks_(points.size()),
        strips_(points.size()),
        below_(points.size(), none),
        above_(points.size(), none),
        order_(IsBelow{this}) {
    triangles_.reserve(points.size() - 2);
    links_.reserve(2 * points.size());
  }

  std::optional<std::vector<std::array<int, 3>>> run() {
    std::vector<int> corners(points_.size());
    std::iota(corners.begin(), corners.end(), 0);
    std::sort(corners.begin(), corners.end(), [&](int a, int b) {
      return std::tuple(at(a).x(), at(a).y(), a) < std::tuple(at(b).x(), at(b).y(), b);
    });
    for (std::size_t k = 0; k < corners.size(); ++k)
      ranks_[index(corners[k])] = static_cast<int>(k);
    for (const int corner : corners)
      if (!pass(corner)) return {};
    if (triangles_.size() + 2 != points_.size()) return {};
    return std::move(triangles_);
  }

 private:
  static constexpr int none = -1;

  static std::size_t index(int k) { return static_cast<std::size_t>(k); }
  const Eigen::Vector2d& at(int corner) const { return points_[index(corner)]; }
  int after(int corner) const { return index(corner) + 1 < points_.size() ? corner + 1 : 0; }
  int before(int corner) const {
    return corner > 0 ? corner - 1 : static_cast<int>(points_.size()) - 1;
  }
  bool is_left(int a, int b) const { return ranks_[index(a)] < ranks_[index(b)]; }
  double turn(int a, int b, int c) const { return pliant::turn(at(a), at(b), at(c)); }

  // One corner of a chain.
  struct Link {
    int corner, down, up;
  };

  // An edge has the number of its first corner: the lower one leads to the right, the upper one to
  // the left. A strip has the number of the corner at which it began.
  struct Strip {
    int lower, upper;
    int first, last, rightmost;  // links
  };

  // Whether the lower edge of a strip is below that of another one, or below a corner.
  struct IsBelow {
    using is_transparent = void;
    struct Corner {
      int number;
    };
    const PolygonSweep* sweep;

    bool operator()(int a, int b) const {
      if (a == b) return false;
      const int left = sweep->lower_of(a), other = sweep->lower_of(b);
      if (sweep->is_left(left, other)) return (*this)(a, Corner{other});
      return !(*this)(b, Corner{left});
    }
    bool operator()(int a, Corner corner) const {
      const int left = sweep->lower_of(a);
      return sweep->turn(left, sweep->after(left), corner.number) > 0;
    }
    bool operator()(Corner corner, int a) const { return !(*this)(a, corner); }
  };

  int lower_of(int strip) const { return strips_[index(strip)].lower; }

  // false: this is no simple polygon.
  bool pass(int corner) {
    const int a = before(corner), b = after(corner);
    const bool is_a_left = is_left(a, corner), is_b_left = is_left(b, corner);
    if (is_a_left && !is_b_left) return extend_lower(corner, a);
    if (!is_a_left && is_b_left) return extend_upper(corner, a);
    const double bend = turn(a, corner, b);
    if (!is_a_left) return bend > 0 ? begin(corner, a) : bend < 0 && split(corner, a);
    return bend > 0 ? end(corner, a) : bend < 0 && merge(corner, a);
  }

  int add_link(int corner) {
    links_.push_back({corner, none, none});
    return static_cast<int>(links_.size()) - 1;
  }

  void join(int down, int up) {
    links_[index(down)].up = up;
    links_[index(up)].down = down;
  }

  void add_triangle(int a, int b, int c) { triangles_.push_back({a, b, c}); }

  // Cuts off all that a corner sees of a chain from a link upwards, and returns the link that is
  // left beside it.
  int see_upwards(int corner, int link) {
    for (int up; (up = links_[index(link)].up) != none; link = up) {
      const int a = links_[index(link)].corner, b = links_[index(up)].corner;
      if (!(turn(a, corner, b) > 0)) break;
      add_triangle(a, corner, b);
    }
    return link;
  }

  int see_downwards(int corner, int link) {
    for (int down; (down = links_[index(link)].down) != none; link = down) {
      const int a = links_[index(link)].corner, b = links_[index(down)].corner;
      if (!(turn(b, corner, a) > 0)) break;
      add_triangle(b, corner, a);
    }
    return link;
  }

  void set_lower(int strip, int edge) {
    strips_[index(strip)].lower = edge;
    below_[index(edge)] = strip;
  }
  void set_upper(int strip, int edge) {
    strips_[index(strip)].upper = edge;
    above_[index(edge)] = strip;
  }

  bool extend_lower(int corner, int a) {
    const int strip = below_[index(a)];
    if (strip == none) return false;
    const int link = add_link(corner);
    join(link, see_upwards(corner, strips_[index(strip)].first));
    strips_[index(strip)].first = strips_[index(strip)].rightmost = link;
    set_lower(strip, corner);
    return true;
  }

  bool extend_upper(int corner, int a) {
    const int strip = above_[index(corner)];
    if (strip == none) return false;
    const int link = add_link(corner);
    join(see_downwards(corner, strips_[index(strip)].last), link);
    strips_[index(strip)].last = strips_[index(strip)].rightmost = link;
    set_upper(strip, a);
    return true;
  }

  bool begin(int corner, int a) {
    const int link = add_link(corner);
    strips_[index(corner)] = {corner, a, link, link, link};
    set_lower(corner, corner);
    set_upper(corner, a);
    return order_.insert(corner).second;
  }

  // The strip below and the one above the two edges to the right; the latter is new.
  bool split(int corner, int a) {
    auto place = order_.lower_bound(IsBelow::Corner{corner});
    if (place == order_.begin()) return false;
    const int strip = *--place;
    Strip& old = strips_[index(strip)];
    if (!(turn(old.upper, after(old.upper), corner) > 0)) return false;
    const int under = add_link(corner), over = add_link(corner), rightmost = old.rightmost;
    // The corner that both see stands in both chains.
    const int twin = add_link(links_[index(rightmost)].corner);
    links_[index(twin)].up = links_[index(rightmost)].up;
    links_[index(rightmost)].up = none;
    const bool is_last = links_[index(twin)].up == none;
    if (!is_last) links_[index(links_[index(twin)].up)].down = twin;
    const int last = is_last ? twin : old.last;
    join(see_downwards(corner, rightmost), under);
    join(over, see_upwards(corner, twin));
    strips_[index(corner)] = {corner, old.upper, over, last, over};
    old.last = old.rightmost = under;
    set_upper(corner, old.upper);
    set_upper(strip, a);
    set_lower(corner, corner);
    return order_.insert(corner).second;
  }

  bool end(int corner, int a) {
    const int strip = below_[index(a)];
    if (strip == none || above_[index(corner)] != strip) return false;
    for (int link = strips_[index(strip)].first, up; (up = links_[index(link)].up) != none;
         link = up) {
      const int low = links_[index(link)].corner, high = links_[index(up)].corner;
      if (!(turn(low, corner, high) >= 0)) return false;
      add_triangle(low, corner, high);
    }
    return order_.erase(strip) == 1;
  }

  // The strip above takes the one below.
  bool merge(int corner, int a) {
    const int over = below_[index(a)], under = above_[index(corner)];
    if (over == none || under == none || over == under) return false;
    const int link = add_link(corner);
    join(link, see_upwards(corner, strips_[index(over)].first));
    join(see_downwards(corner, strips_[index(under)].last), link);
    Strip& merged = strips_[index(under)];
    merged.last = strips_[index(over)].last;
    merged.rightmost = link;
    set_upper(under, strips_[index(over)].upper);
    return order_.erase(over) == 1;
  }

  std::span<const Eigen::Vector2d> points_;
  std::vector<int> ranks_;  // of each corner in the order of the sweep
  std::vector<Strip> strips_;
  std::vector<int> below_, above_;  // of each edge, the strip of which it is the lower (upper) one
  std::vector<Link> links_;
  std::set<int, IsBelow> order_;  // of the strips, from below
  std::vector<std::array<int, 3>> triangles_;
};

}  // namespace

std::optional<std::vector<std::array<int, 3>>> swept_triangles(
    std::span<const Eigen::Vector2d> points) {
  // A corner in the place of the one before would be an edge without a direction.
  std::vector<Eigen::Vector2d> places;
  std::vector<int> corners;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (points[k] == (places.empty() ? points.back() : places.back())) continue;
    places.push_back(points[k]);
    corners.push_back(static_cast<int>(k));
  }
  if (places.size() < 3) return {};
  auto triangles = PolygonSweep(places).run();
  if (!triangles) return {};
  for (auto& triangle : *triangles)
    for (int& corner : triangle) corner = corners[static_cast<std::size_t>(corner)];
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const int next = corners[(k + 1) % corners.size()];
    const int end = k + 1 < corners.size() ? next : static_cast<int>(points.size());
    for (int left_out = corners[k] + 1; left_out < end; ++left_out)
      triangles->push_back({left_out - 1, left_out, next});
  }
  for (int left_out = 0; left_out < corners[0]; ++left_out) {
    const int before = left_out > 0 ? left_out - 1 : static_cast<int>(points.size()) - 1;
    triangles->push_back({before, left_out, corners[0]});
  }
  return triangles;
}

}  // namespace pliant
