#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "pliant/mesh/triangles/triangle_surface.hpp"
#include "pliant/region/triangles/level_set.hpp"
#include "region/select.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

// A force of a program with the answers of another force. Counts the calls, and the most positions
// of one.
struct OwnAnswers {
  int calls = 0;
  std::size_t most = 0;
  bool is_of_many = true;

  SampledForce of(SampledForce force) {
    const ForceKind kind = force.kind;
    const auto answer = [this, kind](const auto& of_one) {
      return [this, kind, of_one](std::span<const Vector3d> points, auto values) {
        ++calls;
        most = std::max(most, points.size());
        for (std::size_t k = 0; k < points.size(); ++k) values[k] = of_one(kind, points[k]);
      };
    };
    const auto distances =
        answer([](const ForceKind& k, const Vector3d& p) { return distance(k, p); });
    const auto forces =
        answer([](const ForceKind& k, const Vector3d& p) { return unit_force(k, p); });
    force.kind =
        SampledCustomForce{[distances](std::span<const Vector3d> points, std::span<double> values) {
                             distances(points, values);
                           },
                           [forces](std::span<const Vector3d> points, std::span<Vector3d> values) {
                             forces(points, values);
                           }};
    return force;
  }
};

SampledForce blast(const Vector3d& center, double deformation_radius, double force_radius) {
  return {.kind = RadialForce{center},
          .magnitude = 3.7,
          .deformation_radius = deformation_radius,
          .force_radius = force_radius,
          .falloff = Falloff::Smooth};
}

// A tube of `columns` round a line along z.
Field tube(const Grid& grid) {
  Field nodes(grid.node_count(), 3);
  for (int j = 0; j < grid.rows; ++j) {
    for (int i = 0; i < grid.columns; ++i) {
      const double angle = 6.283185307179586 * i / grid.columns;
      nodes.row(grid.node(i, j)) << std::cos(angle), std::sin(angle), 2.0 * j / grid.rows;
    }
  }
  return nodes;
}

}  // namespace

TEST_CASE("a program's own force on many nodes is that on each of them", "[region][custom]") {
  // One of more nodes than a call takes, and one whose forces cross a seam.
  const bool is_of_many = GENERATE(true, false);
  for (const bool is_large : {true, false}) {
    const Grid grid = is_large
                          ? Grid{400, 300, 1, 1}
                          : Grid{.columns = 40, .rows = 30, .hu = 1, .hv = 1, .is_closed_u = true};
    const Field nodes = tube(grid);
    OwnAnswers own{.is_of_many = is_of_many};
    std::vector<SampledForce> built_in = {blast({1, 0, 0.7}, 0.9, 0.5), blast({0, 1, 1}, 0.4, 0.8),
                                          blast({-1, 0, 1.4}, 0.5, 0.6)};
    if (is_large) built_in[0].deformation_radius = built_in[0].force_radius = 9;
    std::vector<SampledForce> mixed = {own.of(built_in[0]), built_in[1], own.of(built_in[2])};
    for (const Combine how : {Combine::Box, Combine::Islands, Combine::Union}) {
      const Selection expected = select_region(grid, nodes, built_in, how);
      own = {};
      const Selection found = select_region(grid, nodes, mixed, how);
      REQUIRE(found == expected);
      if (is_of_many) CHECK(own.calls == (is_large ? 4 : 2));
      for (std::size_t region = 0; region < found.regions.size(); ++region) {
        own = {};
        const Field load = assemble_load(grid, nodes, mixed, found, region);
        CHECK(load == assemble_load(grid, nodes, built_in, expected, region));
        CHECK(!load.isZero(0));
        if (is_of_many) CHECK(own.calls <= (is_large ? 8 : 4));
        CHECK(own.most <= asked_at_once(mixed[0].kind));
      }
      for (std::size_t k = 0; k < mixed.size(); ++k) {
        const Box& box = found.forces[k].force;
        const auto patches = found.patches_of_force(k);
        CHECK(pushes(grid, nodes, mixed[k], box, patches));
        const Push push = push_of(grid, nodes, mixed[k], box, patches);
        const Push same = push_of(grid, nodes, built_in[k], box, patches);
        CHECK(push.sum == same.sum);
        CHECK(push.node_count == same.node_count);
      }
    }
  }
}

TEST_CASE("so it is on triangles, and along their normals", "[region][custom][surface]") {
  const TriangleSurface surface = make_surface(sphere(3)).value();
  const Transform transform = make_transform({1, 2, 3}, {10, 20, 30}, {1, -2, 1}, RotateOrder::Xyz);
  const PlacedNodes nodes(surface.rest, transform, nullptr, &surface);
  const PointTree tree(surface.rest);
  std::vector<int> some;
  for (int node = surface.node_count() - 1; node >= 0; node -= 3) some.push_back(node);
  const bool is_of_many = GENERATE(true, false);
  for (const bool is_along_normal : {false, true}) {
    OwnAnswers own{.is_of_many = is_of_many};
    SampledForce built_in = blast({1.5, 2, 3}, 1.3, 0.9);
    built_in.is_along_normal = is_along_normal;
    const SampledForce same = own.of(built_in);
    own = {};
    const std::vector<Vector3d> loads = nodes.loads_on(some, same);
    if (is_of_many) CHECK(own.calls == 2);
    REQUIRE(loads.size() == some.size());
    const std::vector<double> distances = nodes.distances(some, same.kind);
    if (is_of_many) CHECK(own.calls == 3);
    for (std::size_t k = 0; k < some.size(); ++k) {
      CHECK(loads[k] == nodes.load_on(some[k], built_in));
      CHECK(loads[k] == nodes.load_on(some[k], same));
      CHECK(distances[k] == distance(built_in.kind, nodes.at(some[k])));
    }
    Batch sums, expected;
    for (Batch* batch : {&sums, &expected}) {
      batch->count = batch_size;
      for (double* component : {batch->x, batch->y, batch->z})
        std::fill_n(component, batch_size, 0.5);
    }
    nodes.add_loads(100, batch_size - 3, same, 3, sums);
    nodes.add_loads(100, batch_size - 3, built_in, 3, expected);
    for (int k = 0; k < batch_size; ++k) CHECK(sums.at(k) == expected.at(k));
    CHECK(find_level_set(surface, tree, transform, {&same, 1}, {}) ==
          find_level_set(surface, tree, transform, {&built_in, 1}, {}));
  }
}

TEST_CASE("a face is reached where no node is, with many places in a call",
          "[region][custom][surface]") {
  std::mt19937 random(7);
  const auto number = [&](double extent) {
    return std::uniform_real_distribution<double>(-extent, extent)(random);
  };
  int found = 0, missed = 0;
  for (const bool has_quads : {false, true}) {
    const TriangleSurface surface = make_surface(square(12, 6, 0.2, has_quads)).value();
    const PointTree tree(surface.rest);
    for (int trial = 0; trial < 60; ++trial) {
      const Vector3d center{number(3.3), number(0.2), number(3.3)};
      const double radius = trial % 3 == 0 ? std::abs(center.y()) : std::abs(number(0.2));
      OwnAnswers own;
      const SampledForce built_in = blast(center, radius, radius), same = own.of(built_in);
      for (const bool with_faces : {false, true}) {
        const bool expected = reaches(surface, tree, {}, built_in, radius, with_faces);
        own = {};
        REQUIRE(reaches(surface, tree, {}, same, radius, with_faces) == expected);
        CHECK(own.calls < 600);  // about as often as a single triangle may be looked at
        (expected ? found : missed) += with_faces;
      }
    }
  }
  CHECK(found > 10);
  CHECK(missed > 10);
}
