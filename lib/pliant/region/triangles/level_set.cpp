#include "pliant/region/triangles/level_set.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/forces/batch.hpp"

namespace pliant {
namespace {

// A program's own force may say that it is infinitely far away.
constexpr double deepest = 1e150;

// The share of an edge within which the rim moves to its end.
constexpr double snapping_share = 0.1;

bool selects(std::span<const int> selectors, std::size_t k) {
  return selectors.empty() || selectors[k] == static_cast<int>(k);
}

// The box in world space of a box in object space, a little larger.
std::pair<Vector3d, Vector3d> placed_box(const Transform& transform,
                                         const PointTree::Cluster& cluster) {
  const Vector3d middle = to_world(transform, Vector3d(0.5 * (cluster.low + cluster.high)));
  const Vector3d half = 0.5 * (cluster.high - cluster.low);
  Vector3d reach;
  for (int k = 0; k < 3; ++k) {
    reach[k] = std::abs(transform.linear(k, 0)) * half[0] +
               std::abs(transform.linear(k, 1)) * half[1] +
               std::abs(transform.linear(k, 2)) * half[2];
    const double size = std::abs(transform.translation[k]) + std::abs(middle[k]) + reach[k];
    reach[k] += 1e-12 * size;  // rounding
  }
  return {middle - reach, middle + reach};
}

// Calls f(rows, distances) for the nodes of each leaf that may be nearer than the radius, until f
// returns false; of a program's own force for all nodes, in the order of leaves.
template <class F>
void visit_near(const TriangleSurface& surface, const PointTree& tree, const Transform& transform,
                const SampledForce& force, double radius, const F& f) {
  const PlacedNodes nodes(surface.rest, transform);
  if (is_own(force)) {
    const std::span<const int> rows = tree.rows();
    const std::size_t size = asked_at_once(force.kind);
    for (std::size_t first = 0; first < rows.size(); first += size) {
      const auto part = rows.subspan(first, std::min(size, rows.size() - first));
      if (!f(part, nodes.distances(part, force.kind).data())) return;
    }
    return;
  }
  std::vector<int> open;
  if (!tree.clusters().empty()) open.push_back(0);
  while (!open.empty()) {
    const PointTree::Cluster& cluster = tree.clusters()[open.back()];
    open.pop_back();
    const auto [low, high] = placed_box(transform, cluster);
    if (!(least_distance(force.kind, low, high) < radius)) continue;
    if (!cluster.is_leaf()) {
      open.insert(open.end(), {cluster.child + 1, cluster.child});
      continue;
    }
    const std::span<const int> rows(tree.rows().data() + cluster.first,
                                    static_cast<std::size_t>(cluster.count));
    if (!f(rows, distances(force.kind, nodes.batch(rows)).of)) return;
  }
}

// Whether phi changes its sign between two ends of an edge, within a small share of it from the
// first one.
bool is_near_rim(double end, double other) {
  if (end > 0 && other < 0) return end / (end - other) < snapping_share;
  if (end < 0 && other > 0) return 1 - other / (other - end) < snapping_share;
  return false;
}

// The numbers of 0 to `count` - 1, ascending, each once.
std::vector<int> sorted_once(std::vector<int> numbers, int count) {
  if (numbers.size() < static_cast<std::size_t>(count) / 16) {
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    return numbers;
  }
  std::vector<char> is_there(static_cast<std::size_t>(count), 0);
  for (const int number : numbers) is_there[number] = 1;
  numbers.clear();
  for (int number = 0; number < count; ++number) {
    if (is_there[number] != 0) numbers.push_back(number);
  }
  return numbers;
}

// Lists the corners of the level set's faces.
void list_corners(const TriangleSurface& surface, LevelSet& level_set) {
  std::vector<int> all;
  for (const int face : level_set.faces) {
    const std::span<const int> nodes = surface.nodes_of(face);
    all.insert(all.end(), nodes.begin(), nodes.end());
  }
  level_set.nodes = sorted_once(std::move(all), surface.node_count());
  // The place of each node among `all`; of other nodes nothing is written or read.
  const auto places =
      std::make_unique_for_overwrite<int[]>(static_cast<std::size_t>(surface.node_count()));
  for (std::size_t k = 0; k < level_set.nodes.size(); ++k) {
    places[level_set.nodes[k]] = static_cast<int>(k);
  }
  level_set.corner_starts = {0};
  for (const int face : level_set.faces) {
    for (const int node : surface.nodes_of(face)) level_set.corners.push_back(places[node]);
    level_set.corner_starts.push_back(static_cast<int>(level_set.corners.size()));
  }
}

void add_faces_of(const TriangleSurface& surface, std::span<const int> nodes, LevelSet& level_set) {
  for (const int node : nodes) {
    const std::span<const int> faces = surface.faces_of(node);
    level_set.faces.insert(level_set.faces.end(), faces.begin(), faces.end());
  }
  level_set.faces = sorted_once(std::move(level_set.faces), surface.face_count());
}

}  // namespace

LevelSet find_level_set(const TriangleSurface& surface, const PointTree& tree,
                        const Transform& transform, std::span<const SampledForce> forces,
                        std::span<const int> selectors, std::span<const NodeDepth> others) {
  std::vector<int> inside;
  for (const NodeDepth& depth : others) {
    for (int node = 0; node < surface.node_count(); ++node)
      if (depth(node) > 0) inside.push_back(node);
  }
  for (std::size_t k = 0; k < forces.size(); ++k) {
    if (!selects(selectors, k)) continue;
    const double radius = forces[k].deformation_radius;
    visit_near(surface, tree, transform, forces[k], radius,
               [&](std::span<const int> rows, const double* distance) {
                 for (std::size_t n = 0; n < rows.size(); ++n) {
                   if (distance[n] < radius) inside.push_back(rows[n]);
                 }
                 return true;
               });
  }
  LevelSet found;
  add_faces_of(surface, sorted_once(std::move(inside), surface.node_count()), found);
  list_corners(surface, found);
  found.at_nodes.assign(found.nodes.size(), -deepest);
  const PlacedNodes placed(surface.rest, transform);
  std::vector<double> depths;
  for (std::size_t k = 0; k < forces.size(); ++k) {
    if (!selects(selectors, k)) continue;
    depths = depths_of(placed, found.nodes, forces[k].kind, forces[k].deformation_radius,
                       std::move(depths));
    for (std::size_t n = 0; n < depths.size(); ++n) {
      found.at_nodes[n] = std::max(depths[n], found.at_nodes[n]);
    }
  }
  for (const NodeDepth& depth : others) {
    for (std::size_t n = 0; n < found.nodes.size(); ++n)
      found.at_nodes[n] = std::max(std::min(depth(found.nodes[n]), deepest), found.at_nodes[n]);
  }
  found.at_centres = means_at_centres(found, found.at_nodes);
  return found;
}

std::vector<double> depths_of(const PlacedNodes& placed, std::span<const int> nodes,
                              const ForceKind& force, double radius, std::vector<double> reuse) {
  reuse = placed.distances(nodes, force, std::move(reuse));
  for (double& each : reuse) each = std::clamp(radius - each, -deepest, deepest);
  return reuse;
}

std::vector<bool> nodes_within(const TriangleSurface& surface, const LevelSet& level_set,
                               const Transform& transform, const SampledForce& force) {
  const std::vector<double> depths = depths_of(
      PlacedNodes(surface.rest, transform), level_set.nodes, force.kind, force.deformation_radius);
  std::vector<bool> is_within(depths.size());
  for (std::size_t k = 0; k < depths.size(); ++k) is_within[k] = depths[k] > 0;
  return is_within;
}

namespace {

using Corners = std::array<Vector3d, 3>;

// Searches triangles, in world space, for a place nearer than `radius`; all of them at a time, so
// that a program's own force is asked for many places at once.
class TriangleSearch {
 public:
  TriangleSearch(const SampledForce& force, double radius) : force_(force), radius_(radius) {}

  // Whether one of the triangles, or of those that still wait, has such a place. May let it wait.
  bool finds(const Corners& corners) {
    waiting_.push_back({.open = {{corners, 0}}});
    return waiting_.size() == most_waiting && finds();
  }

  // Whether one of those that wait has such a place.
  bool finds() {
    while (!waiting_.empty()) {
      middles_.clear();
      for (const Triangle& one : waiting_) middles_.push_back(middle_of(one.open.back().corners));
      const std::vector<double> least = distances();
      for (std::size_t k = 0; k < waiting_.size(); ++k)
        if (waiting_[k].finds(middles_[k], least[k], radius_)) return true;
      std::erase_if(waiting_, [](const Triangle& one) { return one.open.empty(); });
    }
    return false;
  }

 private:
  static constexpr std::size_t most_waiting = 1024;

  struct Part {
    Corners corners;
    int level;
  };

  // A distance changes by no more than the way to another position, so that most parts are settled
  // at once; what is still open at last touches the force at most.
  struct Triangle {
    std::vector<Part> open;  // the last one is next
    int looks = 0;

    bool finds(const Vector3d& middle, double least, double radius) {
      constexpr int finest = 20, most_looks = 500;
      const auto [corners, level] = open.back();
      open.pop_back();
      double way = 0;
      for (const Vector3d& corner : corners) way = std::max(way, (corner - middle).norm());
      ++looks;
      if (least < radius) return true;
      if (!(least - way < radius) || level == finest || looks > most_looks) return false;
      const auto& [a, b, c] = corners;
      const Vector3d ab = (a + b) / 2, bc = (b + c) / 2, ca = (c + a) / 2;
      for (const Corners& part : {Corners{ab, bc, ca}, {ca, bc, c}, {ab, b, bc}, {a, ab, ca}})
        open.push_back({part, level + 1});
      return false;
    }
  };

  static Vector3d middle_of(const Corners& corners) {
    return (corners[0] + corners[1] + corners[2]) / 3;
  }

  std::vector<double> distances() const {
    std::vector<double> found(middles_.size());
    if (const auto* const own = std::get_if<SampledCustomForce>(&force_.kind)) {
      own->distance(middles_, found);
      return found;
    }
    for (std::size_t k = 0; k < found.size(); ++k) found[k] = distance(force_.kind, middles_[k]);
    return found;
  }

  const SampledForce& force_;
  double radius_;
  std::vector<Triangle> waiting_;
  std::vector<Vector3d> middles_;
};

// Whether a face, or one of those that still wait, is nearer than `radius` anywhere.
bool reaches_face(const TriangleSurface& surface, int face, const Transform& transform,
                  TriangleSearch& search) {
  const auto nodes = surface.nodes_of(face);
  const auto place = [&](int node) {
    return to_world(transform, Vector3d(surface.rest.row(node).transpose()));
  };
  if (!surface.has_centre(face))
    return search.finds({place(nodes[0]), place(nodes[1]), place(nodes[2])});
  Vector3d centre = Vector3d::Zero();
  for (const int node : nodes) centre += place(node) / static_cast<double>(nodes.size());
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    if (search.finds({place(nodes[k]), place(nodes[(k + 1) % nodes.size()]), centre})) return true;
  }
  return false;
}

}  // namespace

bool reaches(const TriangleSurface& surface, const PointTree& tree, const Transform& transform,
             const SampledForce& force, double radius, bool with_faces) {
  bool is_found = false;
  // Of the faces met so far, no less than the way between two of their nodes; 0: looked at. Once
  // for each, as those of many corners are met at every one of them.
  std::map<int, double> widths;
  const auto width_of = [&](int face) {
    Vector3d centre = Vector3d::Zero();
    for (const int node : surface.nodes_of(face)) centre += surface.rest.row(node).transpose();
    centre /= surface.size_of(face);
    double width = 0;
    for (const int node : surface.nodes_of(face)) {
      const Vector3d way = surface.rest.row(node).transpose() - centre;
      width = std::max(width, 2 * (transform.linear * way).norm());
    }
    return width;
  };
  TriangleSearch search(force, radius);
  const double beyond = with_faces ? surface.widest_face * transform.linear.norm() : 0;
  visit_near(surface, tree, transform, force, radius + beyond,
             [&](std::span<const int> rows, const double* distance) {
               for (std::size_t n = 0; n < rows.size() && !is_found; ++n) {
                 is_found = distance[n] < radius;
                 if (is_found || !with_faces) continue;
                 const auto faces = surface.faces_of(rows[n]);
                 // A distance changes by no more than the way to another position.
                 is_found = std::any_of(faces.begin(), faces.end(), [&](int face) {
                   const auto [known, is_new] = widths.try_emplace(face, 0);
                   if (is_new) known->second = width_of(face);
                   if (distance[n] >= radius + known->second) return false;
                   known->second = 0;
                   return reaches_face(surface, face, transform, search);
                 });
               }
               return !is_found;
             });
  return is_found || search.finds();
}

double LevelSet::at_node(int node) const {
  const auto place = std::lower_bound(nodes.begin(), nodes.end(), node);
  return place != nodes.end() && *place == node ? at_nodes[place - nodes.begin()] : -1;
}

LevelSet with_inside(const TriangleSurface& surface, const LevelSet& level_set,
                     std::span<const int> nodes) {
  constexpr double inside = 1;
  LevelSet result;
  result.faces = level_set.faces;
  add_faces_of(surface, nodes, result);
  list_corners(surface, result);
  for (const int node : result.nodes) result.at_nodes.push_back(level_set.at_node(node));
  const auto is_added = [&](int node) {
    return std::binary_search(nodes.begin(), nodes.end(), node);
  };
  std::size_t earlier = 0;  // among the faces of `level_set`
  for (std::size_t k = 0; k < result.faces.size(); ++k) {
    const bool is_old =
        earlier < level_set.faces.size() && level_set.faces[earlier] == result.faces[k];
    result.at_centres.push_back(is_old ? level_set.at_centres[earlier++] : 0);
    const std::span<const int> corners = result.corners_of(k);
    if (std::none_of(corners.begin(), corners.end(),
                     [&](int corner) { return is_added(result.nodes[corner]); })) {
      continue;
    }
    if (surface.has_centre(result.faces[k])) result.at_centres[k] = inside;
    for (const int corner : corners) {
      double& phi = result.at_nodes[corner];
      phi = is_added(result.nodes[corner]) ? inside : std::max(phi, 0.0);
    }
  }
  return result;
}

std::vector<double> means_at_centres(const LevelSet& level_set, std::span<const double> at_nodes,
                                     std::vector<double> reuse) {
  reuse.assign(level_set.faces.size(), 0);
  for (std::size_t k = 0; k < level_set.faces.size(); ++k) {
    const std::span<const int> corners = level_set.corners_of(k);
    if (corners.size() == 3) continue;
    double sum = 0;
    for (const int corner : corners) sum += at_nodes[corner];
    reuse[k] = sum / static_cast<double>(corners.size());
  }
  return reuse;
}

void snap(LevelSet& level_set) {
  std::vector<bool> is_node_moved(level_set.nodes.size()), is_centre_moved(level_set.faces.size());
  for (std::size_t k = 0; k < level_set.faces.size(); ++k) {
    const std::span<const int> corners = level_set.corners_of(k);
    const double centre = level_set.at_centres[k];
    for (std::size_t n = 0; n < corners.size(); ++n) {
      const int here = corners[n], next = corners[(n + 1) % corners.size()];
      const double phi = level_set.at_nodes[here];
      if (is_near_rim(phi, level_set.at_nodes[next])) is_node_moved[here] = true;
      if (is_near_rim(level_set.at_nodes[next], phi)) is_node_moved[next] = true;
      if (corners.size() == 3) continue;
      if (is_near_rim(phi, centre)) is_node_moved[here] = true;
      if (is_near_rim(centre, phi)) is_centre_moved[k] = true;
    }
  }
  for (std::size_t k = 0; k < is_node_moved.size(); ++k) {
    if (is_node_moved[k]) level_set.at_nodes[k] = 0;
  }
  for (std::size_t k = 0; k < is_centre_moved.size(); ++k) {
    if (is_centre_moved[k]) level_set.at_centres[k] = 0;
  }
}

}  // namespace pliant
