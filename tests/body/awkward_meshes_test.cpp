#include "body/awkward_meshes.hpp"

#include <algorithm>
#include <numeric>

#include "body/sheets.hpp"
#include "pliant/body/triangle_body.hpp"
#include "support/catch.hpp"
#include "support/sanitized.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

constexpr int frame_count = 4;

// What some frames of a push and a pull make of a mesh: the displacement of each vertex.
struct Played {
  Field ways;
  bool moves = false;
  std::vector<bool> is_far;  // from all forces, so that it must not move
};

Played played(const Mesh& mesh, const SampledForce& force, std::optional<double> weld) {
  auto surface = std::make_shared<TriangleSurface>(make_surface(mesh, {.weld = weld}).value());
  TriangleBody body(surface, {.measure = Measure::Rest});
  BodyInputs in;
  in.frame_length = 1.0 / 24;
  in.dt = 0.02;
  in.dynamics = {0.01, 0.05};
  in.forces = {force};
  Played result;
  for (int frame = 0; frame < frame_count; ++frame) {
    in.forces[0].magnitude = frame % 2 == 0 ? force.magnitude : -0.3 * force.magnitude;
    REQUIRE(body.step(in));
    result.moves = result.moves || body.last_step().solves();
  }
  result.ways = Field::Zero(mesh.vertex_count(), 3);
  for (int vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
    const int node = surface->vertex_nodes[vertex];
    if (node >= 0)
      result.ways.row(vertex) = body.state().positions.row(node) - body.rest().row(node);
    result.is_far.push_back(node < 0 || distance(force.kind, surface->rest.row(node).transpose()) >=
                                            force.deformation_radius);
  }
  return result;
}

SampledForce force_on(const AwkwardMesh& awkward) {
  return {PointForce{awkward.center, {0.2, 1, -0.1}}, 1, awkward.radius, 0.6 * awkward.radius,
          Falloff::Smooth};
}

double largest(const Field& ways) { return ways.rowwise().norm().maxCoeff(); }

// The mesh with its vertices and faces in another order; order[k] is the new number of vertex k.
Mesh reordered(const Mesh& mesh, const std::vector<int>& order, std::mt19937& random) {
  Places places(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) places[order[k]] = places_of(mesh)[k];
  Faces faces = faces_of(mesh);
  for (auto& face : faces) {
    for (int& vertex : face) vertex = order[vertex];
  }
  std::shuffle(faces.begin(), faces.end(), random);
  return mesh_of(places, faces);
}

}  // namespace

TEST_CASE("awkward meshes move as they should", "[body][surface][awkward]") {
  const std::vector<AwkwardMesh> all = awkward_meshes();
  REQUIRE(all.size() >= 40);
  std::mt19937 random(3);
  int moving = 0;
  for (const AwkwardMesh& awkward : all) {
    CAPTURE(awkward.name);
    const Mesh& mesh = awkward.mesh;
    // As strong as to be seen: otherwise little is left of a motion in the digits of positions.
    SampledForce force = force_on(awkward);
    const double first = largest(played(mesh, force, awkward.weld).ways);
    if (first > 0) force.magnitude = 0.2 * awkward.radius / first;
    const Played plain = played(mesh, force, awkward.weld);
    moving += plain.moves ? 1 : 0;
    CHECK(plain.ways.allFinite());
    const double peak = largest(plain.ways);
    CHECK((peak > 0) == plain.moves);
    for (int vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
      if (plain.is_far[vertex]) CHECK(plain.ways.row(vertex).isZero(0));
    }
    if (is_sanitized) continue;  // the rest is the same code again
    CHECK(played(mesh, force, awkward.weld).ways == plain.ways);

    std::vector<int> order(static_cast<std::size_t>(mesh.vertex_count()));
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), random);
    // The largest difference over the peak; of what does not move, the difference itself.
    const auto error = [&](const Field& ways) {
      return largest(ways - plain.ways) / (peak > 0 ? peak : 1);
    };
    Field back = plain.ways;
    const Field other = played(reordered(mesh, order, random), force, awkward.weld).ways;
    for (std::size_t k = 0; k < order.size(); ++k) {
      back.row(static_cast<Eigen::Index>(k)) = other.row(order[k]);
    }
    CHECK(error(back) <= 1e-8);

    const Transform turn = make_transform({0, 0, 0}, {20, 70, -40}, {1, 1, 1}, RotateOrder::Xyz);
    Mesh turned = mesh;
    turned.positions = to_world(turn, mesh.positions);
    SampledForce its = force;
    const auto& point = std::get<PointForce>(force.kind);
    its.kind = PointForce{to_world(turn, point.center), turn.linear * point.direction};
    CHECK(error(played(turned, its, awkward.weld).ways * turn.linear) <= 1e-8);

    Places split;
    Faces faces = faces_of(mesh);
    std::vector<int> origin;
    for (auto& face : faces) {
      for (int& vertex : face) {
        origin.push_back(vertex);
        split.push_back(mesh.positions.row(vertex).transpose());
        vertex = static_cast<int>(split.size()) - 1;
      }
    }
    const Field apart = played(mesh_of(split, faces), force, awkward.weld).ways;
    for (std::size_t k = 0; k < origin.size(); ++k) {
      back.row(origin[k]) = apart.row(static_cast<Eigen::Index>(k));
    }
    CHECK(error(back) <= 1e-8);
  }
  CHECK(moving >= 38);
}
