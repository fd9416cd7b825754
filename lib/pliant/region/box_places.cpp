#include "pliant/region/box_places.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>

namespace pliant {
namespace {

namespace geometry = boost::geometry;

using BoxArea = geometry::model::box<geometry::model::d2::point_xy<int>>;
using NumberedArea = std::pair<BoxArea, int>;

BoxArea area_of(const Box& box) { return {{box.i0, box.j0}, {box.i1, box.j1}}; }

}  // namespace

struct BoxPlaces::Tree {
  geometry::index::rtree<NumberedArea, geometry::index::quadratic<16>> places;
};

BoxPlaces::BoxPlaces(const Grid& grid) : grid_(grid), tree_(std::make_unique<Tree>()) {}
BoxPlaces::~BoxPlaces() = default;

void BoxPlaces::insert(const Box& box, int number) {
  tree_->places.insert(NumberedArea(area_of(box), number));
}

void BoxPlaces::remove(const Box& box, int number) {
  tree_->places.remove(NumberedArea(area_of(box), number));
}

std::vector<int> BoxPlaces::meeting(const Box& box) const {
  std::vector<int> numbers;
  if (box.is_empty()) return numbers;
  const int laps_u = grid_.is_closed_u ? 1 : 0, laps_v = grid_.is_closed_v ? 1 : 0;
  for (int v = -laps_v; v <= laps_v; ++v) {
    for (int u = -laps_u; u <= laps_u; ++u) {
      const BoxArea moved = area_of({box.i0 + u * grid_.columns, box.i1 + u * grid_.columns,
                                     box.j0 + v * grid_.rows, box.j1 + v * grid_.rows});
      for (auto place = tree_->places.qbegin(geometry::index::intersects(moved));
           place != tree_->places.qend(); ++place) {
        numbers.push_back(place->second);
      }
    }
  }
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return numbers;
}

}  // namespace pliant
