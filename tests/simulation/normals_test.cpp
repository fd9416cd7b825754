#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "pliant/forces/force.hpp"
#include "pliant/mesh/node_faces.hpp"
#include "support/area_vectors.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;

// Forces along the normals of a surface. SPEC 7.

namespace {

Force pressure(double magnitude = 3000) {
  Force force = poke("pressure", {0, 0, 0}, magnitude);
  force.kind = PressureChannels{};
  return force;
}

Surface of_triangles(Surface surface, Mesh mesh) {
  surface.shape = std::move(mesh);
  surface.reading.uv = UvReading::Surface;
  return surface;
}

// A sheet that is a hill.
Mesh hill() {
  Mesh mesh = make_mesh(std::get<GridSheet>(sheet("s").shape));
  for (Eigen::Index row = 0; row < mesh.positions.rows(); ++row)
    mesh.positions(row, 1) = 3 * std::exp(-0.08 * mesh.positions.row(row).squaredNorm());
  return mesh;
}

// The unit normals of vertices by a sum over all faces.
Field normals_of(Mesh mesh, const Field& positions) {
  mesh.positions = positions;
  const Field areas = area_vectors(mesh);
  Field sums = Field::Zero(positions.rows(), 3);
  std::size_t corner = 0;
  for (std::size_t face = 0; face < mesh.face_sizes.size(); ++face) {
    for (int k = 0; k < mesh.face_sizes[face]; ++k)
      sums.row(mesh.corner_vertices[corner++]) += areas.row(static_cast<Eigen::Index>(face));
  }
  return sums.rowwise().normalized();
}

}  // namespace

TEST_CASE("pressure on a flat sheet is a uniform force along its normal", "[simulation][normals]") {
  const bool is_grid = GENERATE(true, false);
  Surface surface = is_grid ? sheet("s") : of_triangles(sheet("s"), square(12, 12, 0.2));
  surface.solver.measure = Measure::Rest;
  surface.transform.rotate = Value<3>{30, 40, 50};
  surface.transform.scale = Value<3>{1.2, -0.7, 2};  // mirrored
  const Vector3d up = surface.transform.at(1).linear * Vector3d(0, 1, 0);
  // Along an axis of the scale the inverse transpose, by which normals go, keeps the direction.
  Force push = pressure();
  push.deformation_radius = push.force_radius = 1000;
  Force uniform = push;
  uniform.kind = UniformChannels{.direction = Value<3>{up.x(), up.y(), up.z()}};
  const std::vector<Field> expected = baked(scene({surface}, {uniform}), "s");
  const std::vector<Field> found = baked(scene({surface}, {push}), "s");
  REQUIRE(peak(expected) > 0.01);
  for (std::size_t k = 0; k < found.size(); ++k)
    CHECK(largest_difference(found[k], expected[k]) < 1e-12 * peak(expected));
}

TEST_CASE("normals are those of the faces around a node, in the world", "[simulation][normals]") {
  const Mesh mesh = hill();
  const auto faces = node_faces(
                         mesh,
                         [&] {
                           std::vector<int> nodes;
                           for (int k = 0; k < mesh.vertex_count(); ++k) nodes.push_back(k);
                           return nodes;
                         }(),
                         mesh.vertex_count())
                         .value();
  const Transform transform =
      make_transform({1, 2, 3}, {10, 20, 30}, {1, -2, 0.5}, RotateOrder::Xyz);
  Field expected = normals_of(mesh, mesh.positions);
  // Of a mirrored mesh the faces turn; its outer side stays the outer one.
  expected = (expected * inverse_linear(transform)).eval();
  expected.rowwise().normalize();
  for (int node = 0; node < mesh.vertex_count(); ++node) {
    const Vector3d found =
        normal_at(faces, mesh.positions, inverse_linear(transform).transpose(), node);
    CHECK((found - expected.row(node).transpose()).norm() < 1e-14);
  }
}

TEST_CASE("normals of a run have the bits of those one by one", "[simulation][normals]") {
  Mesh hilly = hill();
  const int kind = GENERATE(0, 1, 2, 3);
  if (kind == 1 || kind == 2) {  // each cell the other way round, or from another corner
    for (std::size_t first = 0; first < hilly.corner_vertices.size(); first += 4) {
      const auto corners = hilly.corner_vertices.begin() + static_cast<std::ptrdiff_t>(first);
      if (kind == 1) std::reverse(corners, corners + 4);
      if (kind == 2) std::rotate(corners, corners + static_cast<int>(first / 4 % 4), corners + 4);
    }
  }
  if (kind == 3) std::swap(hilly.corner_vertices[1], hilly.corner_vertices[3]);  // one is turned
  std::vector<int> nodes(static_cast<std::size_t>(hilly.vertex_count()));
  std::iota(nodes.begin(), nodes.end(), 0);
  const int count = hilly.vertex_count();
  const NodeFaces cells = node_faces(hilly, nodes, count).value();
  CHECK((cells.grid_columns == 0) == (kind == 3));
  if (kind < 3) CHECK(cells.is_turned == (kind != 1));  // those of a sheet are
  NodeFaces any = cells;
  any.grid_columns = 0;
  const Matrix3d turn =
      inverse_linear(make_transform({}, {10, 20, 30}, {1, -2, 0.5}, RotateOrder::Xyz)).transpose();
  for (int first = 0; first < count; first += 7) {
    const int size = std::min(first % 5 == 0 ? most_normals : first % most_normals, count - first);
    Field found(size, 3);
    normals_of_run(cells, hilly.positions, turn, first, size,
                   {found.col(0).data(), found.col(1).data(), found.col(2).data()});
    for (int k = 0; k < size; ++k) {
      const Vector3d normal = found.row(k).transpose();
      CHECK(normal == normal_at(cells, hilly.positions, turn, first + k));
      CHECK(normal == normal_at(any, hilly.positions, turn, first + k));
    }
  }
}

TEST_CASE("normals of tiny and of huge faces are as those of others", "[simulation][normals]") {
  const Mesh mesh = hill();
  std::vector<int> nodes(static_cast<std::size_t>(mesh.vertex_count()));
  std::iota(nodes.begin(), nodes.end(), 0);
  const NodeFaces faces = node_faces(mesh, nodes, mesh.vertex_count()).value();
  const Field expected = normals_of(mesh, mesh.positions);
  for (const double scale : {1e-75, 1e-60, 1e60, 1e75}) {
    const Field scaled = scale * mesh.positions;
    for (int node = 0; node < mesh.vertex_count(); ++node) {
      const Vector3d found = normal_at(faces, scaled, Matrix3d::Identity(), node);
      CHECK((found - expected.row(node).transpose()).norm() < 1e-14);
    }
  }
}

TEST_CASE("a face that is left with fewer than three nodes has none", "[simulation][normals]") {
  const Mesh mesh = mesh_of({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 2, 3}, {5, 5, 5}},
                            {{0, 1, 2}, {0, 3, 4}, {1, 4, 3}, {0, 1, 3, 2}});
  const auto faces = node_faces(mesh, {0, 1, 2, -1, -1}, 3).value();
  CHECK(faces.face_count() == 4);
  CHECK(faces.faces_of(1).size() == 2);
  for (int node = 0; node < 3; ++node) {
    const Vector3d normal = normal_at(faces, mesh.positions, Matrix3d::Identity(), node);
    CHECK(normal == Vector3d(0, 1, 0));
  }
}

TEST_CASE("a node whose faces cancel each other has no normal", "[simulation][normals]") {
  // Two triangles back to back, and a third one that is larger than rounding by chance.
  for (const double third : {0.0, 1e-13, 1e-3}) {
    const Mesh mesh = mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {third, third, 0}},
                              {{0, 1, 2}, {0, 2, 1}, {0, 1, 3}});
    const auto faces = node_faces(mesh, {0, 1, 2, 3}, 4).value();
    const Vector3d normal = normal_at(faces, mesh.positions, Matrix3d::Identity(), 0);
    CHECK_THAT(normal.norm(), WithinAbs(third > 1e-12 ? 1 : 0, 1e-14));
  }
}

TEST_CASE("along=normal keeps the part of the force along the normal", "[simulation][normals]") {
  // One static frame: the response is linear in the load, so that a load for each node alone is a
  // sum by hand.
  const bool is_grid = GENERATE(true, false);
  const int kind = GENERATE(0, 1, 2, 3, 4);
  Surface surface = sheet("s");
  surface.material.density = surface.material.damping = 0.0;
  if (is_grid)
    surface.shape = hill();
  else
    surface = of_triangles(surface, hill());
  const Value<3> center = {0.5, 1, -0.5};
  Force push = poke("push", center, 500);
  if (kind == 0) push.kind = PointChannels{.center = center, .direction = Value<3>{0.3, 1, -0.4}};
  if (kind == 1) push.kind = UniformChannels{.direction = Value<3>{1, 0.2, 0}};
  if (kind == 2) push.kind = LineChannels{.from = center};
  if (kind == 3) push.kind = VortexChannels{.center = center, .pull = 0.5};
  if (kind == 4) push.kind = NoiseChannels{.center = center, .frequency = 0.3};
  push.falloff = Falloff::Smooth;
  push.along = PushAlong::Normal;
  const Scene made = scene({surface}, {push}, 2);
  auto simulation = Simulation::make(made).value();
  const FrameReport report = simulation.report(1).value();
  const ForceReport& told = report.surfaces[0].forces[0];
  // A program's own force with the normals of the same mesh.
  const Field rest = hill().positions;
  const Field normals = normals_of(hill(), rest);
  Force own = push;
  own.along = PushAlong::Free;
  own.kind = CustomForce{
      .distance = [kind = told.sampled->kind](const Vector3d& p,
                                              const ForceTime&) { return distance(kind, p); },
      .unit_force =
          [&, kind = told.sampled->kind](const Vector3d& p, const ForceTime&) {
            Eigen::Index node = 0;
            (rest.rowwise() - p.transpose()).rowwise().squaredNorm().minCoeff(&node);
            const Vector3d normal = normals.row(node).transpose();
            return Vector3d(normal.dot(unit_force(kind, p)) * normal);
          }};
  const std::vector<Field> found = baked(made, "s");
  const std::vector<Field> expected = baked(scene({surface}, {own}, 2), "s");
  REQUIRE(peak(expected) > 1e-4);
  CHECK(largest_difference(found.back(), expected.back()) < 1e-12 * peak(expected));
}

TEST_CASE("pressure blows a sphere up evenly", "[simulation][normals]") {
  Surface surface = of_triangles(sheet("s"), sphere(4));
  surface.reading.unit = std::array{1.0, 1.0};
  surface.solver.region = SolvedRegion::All;
  surface.material.density = 1.0;
  Force push = pressure(1);
  push.force_radius = 100;
  const std::vector<Field> frames = baked(scene({surface}, {push}, 3), "s");
  const Field way = frames[1] - frames[0];
  REQUIRE(peak(frames) > 1e-6);
  double most = 0, least = 1e9;
  for (Eigen::Index row = 0; row < way.rows(); ++row) {
    const Vector3d out = frames[0].row(row).transpose().normalized();
    const double outward = way.row(row).dot(out);
    most = std::max(most, outward), least = std::min(least, outward);
    CHECK((way.row(row).transpose() - outward * out).norm() < 0.01 * outward);
  }
  CHECK(least > 0.98 * most);
}
