#include "pliant/feedback/cut_outline.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>

#include "support/catch.hpp"
#include "support/meshes.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

constexpr double half_side = 0.5;  // of a square of side 1

SampledForce around(const Vector3d& center, double radius) {
  return {PointForce{center, {0, 1, 0}}, 1, radius, 0, Falloff::Constant};
}

// A region, with the outline of each of its patches.
struct CutRegion {
  TriangleSurface surface;
  LevelSet level_set;
  std::vector<TrianglePatch> patches;

  CutRegion(const Mesh& mesh, const std::vector<SampledForce>& forces,
            Border kind = Border::Clamped)
      : surface(make_surface(mesh).value()) {
    level_set = find_level_set(surface, PointTree(surface.rest), {}, forces, {});
    snap(level_set);
    std::vector<bool> is_border;
    for (int node = 0; node < surface.node_count(); ++node) {
      const double farthest = surface.rest.row(node).cwiseAbs().maxCoeff();
      is_border.push_back(surface.rest.col(1).isZero() && farthest > half_side - 1e-9);
    }
    patches = cut_out(surface, level_set, is_border, kind).value();
  }

  std::vector<double> depths(const SampledForce& force) const {
    return depths_of(surface.rest, level_set.nodes, force.kind, force.deformation_radius);
  }

  // Values on the nodes of the level set, linear on each triangle, at the ends of segments.
  std::vector<double> at_ends(const SurfaceLines& lines, const std::vector<double>& values) const {
    Field at_nodes = Field::Constant(surface.node_count(), 3, std::nan(""));
    for (std::size_t k = 0; k < values.size(); ++k) {
      at_nodes.row(level_set.nodes[k]).setConstant(values[k]);
    }
    const Field points = lines.points(at_nodes);
    std::vector<double> at;
    for (const auto& [a, b] : lines.segments) at.insert(at.end(), {points(a, 0), points(b, 0)});
    return at;
  }
};

// Whether each end is that of an even number of segments.
bool is_closed(const SurfaceLines& lines) {
  std::map<int, int> ends;
  for (const auto& [a, b] : lines.segments) {
    ++ends[a];
    ++ends[b];
  }
  return std::all_of(ends.begin(), ends.end(), [](const auto& end) { return end.second % 2 == 0; });
}

double length_of(const SurfaceLines& lines, const Field& positions) {
  const Field points = lines.points(positions);
  double length = 0;
  for (const auto& [a, b] : lines.segments) length += (points.row(b) - points.row(a)).norm();
  return length;
}

// The segments as positions but for rounding, in any order and direction.
std::set<std::array<std::int64_t, 6>> places_of(const SurfaceLines& lines, const Field& positions) {
  const Field points = lines.points(positions);
  std::set<std::array<std::int64_t, 6>> places;
  for (const auto& [from, to] : lines.segments) {
    const auto numbers = [&](int a, int b) {
      std::array<std::int64_t, 6> place;
      for (int k = 0; k < 3; ++k) {
        place[k] = std::llround(1e9 * points(a, k));
        place[k + 3] = std::llround(1e9 * points(b, k));
      }
      return place;
    };
    places.insert(std::min(numbers(from, to), numbers(to, from)));
  }
  return places;
}

// The sphere with all vertices on one side of x = 0 and on it once more, for the faces there.
Mesh split(const Mesh& whole) {
  Mesh mesh = whole;
  std::map<int, int> twins;
  std::size_t corner = 0;
  for (const int size : whole.face_sizes) {
    double x = 0;
    for (int k = 0; k < size; ++k) x += whole.positions(whole.corner_vertices[corner + k], 0);
    for (int k = 0; k < size; ++k, ++corner) {
      if (x > 0) continue;
      const int vertex = whole.corner_vertices[corner];
      const auto count = static_cast<int>(twins.size());
      mesh.corner_vertices[corner] =
          twins.try_emplace(vertex, whole.vertex_count() + count).first->second;
    }
  }
  mesh.positions.conservativeResize(whole.vertex_count() + static_cast<int>(twins.size()), 3);
  for (const auto& [vertex, twin] : twins) mesh.positions.row(twin) = whole.positions.row(vertex);
  return mesh;
}

}  // namespace

TEST_CASE("the outline of a patch is closed and lies where phi is 0", "[feedback][outline]") {
  for (const Mesh& mesh : {sphere(3), square(20, 1, 0.3), square(20, 1, 0.3, true)}) {
    const bool is_flat = mesh.positions.col(1).isZero();
    const Vector3d center = is_flat ? Vector3d(0.05, 0, -0.03) : Vector3d(0.1, 1, 0.2);
    const double radius = is_flat ? 0.31 : 0.7;
    const CutRegion region(mesh, {around(center, radius)});
    REQUIRE(region.patches.size() == 1);
    const SurfaceLines lines = outline_of(region.patches[0], region.level_set);
    CHECK(lines.segments.size() > 20);
    CHECK(is_closed(lines));
    // With triangles to the last digits; the centre of a quad may have been moved to 0 by itself.
    const bool has_centres = mesh.face_sizes[0] > 3;
    for (const double phi : region.at_ends(lines, region.level_set.at_nodes)) {
      CHECK(std::abs(phi) < (has_centres ? 0.1 / 20 : 1e-15));
    }
    const Field points = lines.points(region.surface.rest);
    const double spacing = is_flat ? 1.0 / 20 : 0.17;
    for (const std::array<int, 2>& segment : lines.segments) {
      const Vector3d end = points.row(segment[0]).transpose();
      CHECK(std::abs((end - center).norm() - radius) < 0.2 * spacing);
    }
    const double across = is_flat ? radius : std::sqrt(0.49 - std::pow(0.49 / 2, 2));
    CHECK_THAT(length_of(lines, region.surface.rest),
               Catch::Matchers::WithinRel(6.2832 * across, 0.05));
  }
}

TEST_CASE("a border belongs to the outline if it is held", "[feedback][outline]") {
  const Mesh mesh = square(16, 1, 0.3, GENERATE(false, true));
  const SampledForce force = around({0.3, 0, 0.1}, 0.35);
  const CutRegion held(mesh, {force}), free(mesh, {force}, Border::Free);
  const SurfaceLines closed = outline_of(held.patches[0], held.level_set);
  const SurfaceLines open = outline_of(free.patches[0], free.level_set);
  CHECK(is_closed(closed));
  CHECK_FALSE(is_closed(open));
  const auto on_border = [&](const SurfaceLines& lines) {
    const Field points = lines.points(held.surface.rest);
    double length = 0;
    for (const auto& [a, b] : lines.segments) {
      if (points(a, 0) > half_side - 1e-9 && points(b, 0) > half_side - 1e-9)
        length += std::abs(points(b, 2) - points(a, 2));
    }
    return length;
  };
  // A chord of the circle.
  CHECK_THAT(on_border(closed),
             Catch::Matchers::WithinRel(2 * std::sqrt(0.35 * 0.35 - 0.04), 0.02));
  CHECK(on_border(open) == 0);
  CHECK_THAT(length_of(closed, held.surface.rest) - length_of(open, held.surface.rest),
             Catch::Matchers::WithinAbs(on_border(closed), 1e-12));
  // What a force pushes is an area, whatever its border does.
  const auto depths = free.depths(around({0.4, 0, 0.1}, 0.2));
  CHECK(is_closed(outline_of(free.patches, free.level_set, depths)));
}

TEST_CASE("an outline crosses a seam as if there were none", "[feedback][outline]") {
  const Mesh whole = sphere(3), seam = split(whole);
  REQUIRE(seam.vertex_count() > whole.vertex_count() + 300);
  const SampledForce force = around({0.02, 1, 0.1}, 0.6), small = around({0, 1, 0.2}, 0.3);
  const CutRegion a(whole, {force}), b(seam, {force});
  REQUIRE(a.patches.size() == 1);
  REQUIRE(b.patches.size() == 1);
  const SurfaceLines lines = outline_of(b.patches[0], b.level_set);
  CHECK(is_closed(lines));
  CHECK(places_of(lines, b.surface.rest) ==
        places_of(outline_of(a.patches[0], a.level_set), a.surface.rest));
  const SurfaceLines pushed = outline_of(b.patches, b.level_set, b.depths(small));
  CHECK(is_closed(pushed));
  CHECK(places_of(pushed, b.surface.rest) ==
        places_of(outline_of(a.patches, a.level_set, a.depths(small)), a.surface.rest));
}

TEST_CASE("what a force pushes ends where its radius or the region does", "[feedback][outline]") {
  const bool has_quads = GENERATE(false, true);
  const CutRegion region(square(20, 1, 0.3, has_quads), {around({0, 0, 0}, 0.3)});
  const SurfaceLines rim = outline_of(region.patches[0], region.level_set);
  const auto pushed = [&](const Vector3d& center, double radius) {
    return outline_of(region.patches, region.level_set, region.depths(around(center, radius)));
  };
  const SurfaceLines within = pushed({0.02, 0, 0.03}, 0.17);
  CHECK(is_closed(within));
  for (const double depth : region.at_ends(within, region.depths(around({0.02, 0, 0.03}, 0.17)))) {
    CHECK(std::abs(depth) < 1e-15);
  }
  CHECK_THAT(length_of(within, region.surface.rest),
             Catch::Matchers::WithinRel(6.2832 * 0.17, 0.02));

  // It holds all of the region, none of it, or a part.
  CHECK(places_of(pushed({0, 0, 0}, 5), region.surface.rest) ==
        places_of(rim, region.surface.rest));
  CHECK(pushed({0, 3, 0}, 0.5).segments.empty());
  const SurfaceLines part = pushed({0.2, 0, 0}, 0.25);
  CHECK(is_closed(part));
  for (const double depth : region.at_ends(part, region.depths(around({0.2, 0, 0}, 0.25)))) {
    CHECK(depth > -0.005);
  }
  CHECK(length_of(part, region.surface.rest) < 6.2832 * 0.25);
  // The same radius: the rim, where it has not been moved.
  const SurfaceLines equal = pushed({0, 0, 0}, 0.3);
  CHECK(is_closed(equal));
  CHECK_THAT(length_of(equal, region.surface.rest),
             Catch::Matchers::WithinRel(length_of(rim, region.surface.rest), 0.02));
}
