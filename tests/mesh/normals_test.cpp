#include "pliant/mesh/normals.hpp"

#include <Eigen/Geometry>

#include "pliant/mesh/grid_sheet.hpp"
#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

// A cube of side 2 around the origin: 8 vertices, 6 quads with outward orientation.
Mesh cube() {
  Mesh mesh;
  mesh.positions.resize(8, 3);
  for (int k = 0; k < 8; ++k)
    mesh.positions.row(k) << (k & 1 ? 1 : -1), (k & 2 ? 1 : -1), (k & 4 ? 1 : -1);
  mesh.corner_vertices = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
  mesh.corner_uvs.assign(24, -1);
  mesh.face_sizes.assign(6, 4);
  return mesh;
}

}  // namespace

TEST_CASE("normals of a smooth cube point to its corners", "[mesh][normals]") {
  const Mesh mesh = cube();
  const Field normals = unit_normals(mesh, mesh.positions);
  CHECK(normal_count(mesh) == 8);
  CHECK_FALSE(is_flat(mesh));
  CHECK((normals - mesh.positions / std::sqrt(3.0)).cwiseAbs().maxCoeff() < 1e-15);
}

TEST_CASE("normals of a flat cube are those of its faces", "[mesh][normals]") {
  Mesh mesh = cube();
  mesh.corner_normals = shared_normals(mesh, {{}, {}, std::vector<int>(6, Shading::flat)}).value();
  CHECK(is_flat(mesh));
  REQUIRE(normal_count(mesh) == 6);
  const Field normals = unit_normals(mesh, mesh.positions);
  for (std::size_t corner = 0; corner < 24; ++corner) {
    const Vector3d normal = normals.row(normal_of(mesh, corner));
    CHECK(normal.cwiseAbs().maxCoeff() == 1);
    CHECK(normal.dot(mesh.positions.row(mesh.corner_vertices[corner])) == 1);  // outward
  }
}

TEST_CASE("normals turn with the mesh and do not know its size", "[mesh][normals]") {
  Mesh mesh = make_mesh({.columns = 5, .rows = 4});
  mesh.positions += 0.1 * Field::Random(20, 3);
  const double size = GENERATE(1e-100, 1e-3, 1.0, 1e100);
  const Matrix3d turn =
      Eigen::AngleAxisd(0.7, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  const Field turned = size * mesh.positions * turn.transpose();
  const Field expected = unit_normals(mesh, mesh.positions) * turn.transpose();
  // Positions near 1 and areas near 0.05 lose some 50 units in the last place.
  CHECK((unit_normals(mesh, turned) - expected).cwiseAbs().maxCoeff() < 1e-13);
}

TEST_CASE("where there is no normal it points up", "[mesh][normals]") {
  Mesh mesh = make_mesh({});
  mesh.positions.conservativeResize(10, 3);
  mesh.positions.row(9).setZero();  // a vertex without a face
  CHECK(unit_normals(mesh, mesh.positions).row(9) == Eigen::RowVector3d(0, 1, 0));
  CHECK(unit_normals(mesh, Field::Zero(10, 3)).row(0) == Eigen::RowVector3d(0, 1, 0));
}

TEST_CASE("equal normals at equal places are one, across a seam too", "[mesh][normals]") {
  Mesh mesh;  // two quads that meet but have separate vertices
  mesh.positions.resize(8, 3);
  mesh.positions << 0, 0, 0, 0, 0, 1, 1, 0, 1, 1, 0, 0, 1, 0, 0, 1, 0, 1, 2, 1, 1, 2, 1, 0;
  mesh.face_sizes = {4, 4};
  mesh.corner_vertices = {0, 1, 2, 3, 4, 5, 6, 7};
  mesh.corner_uvs.assign(8, -1);
  const std::array<double, 3> up = {0, 1, 0}, tilted = {-0.6, 0.8, 0}, between = {-0.3, 0.9, 0};
  Shading shading{{up, between, tilted}, {0, 0, 1, 1, 1, 1, 2, 2}, {}};
  const std::vector<int> joined = shared_normals(mesh, shading).value();
  CHECK(joined[2] == joined[5]);
  CHECK(joined[3] == joined[4]);
  CHECK(joined[2] != joined[3]);
  shading.corner_normals = {0, 0, 0, 0, 2, 2, 2, 2};
  const std::vector<int> creased = shared_normals(mesh, shading).value();
  CHECK(creased[2] != creased[5]);
  mesh.corner_normals = creased;
  CHECK(check_mesh(mesh));
}

TEST_CASE("what a file does not say is smooth", "[mesh][normals]") {
  const Mesh mesh = cube();
  CHECK(shared_normals(mesh, {}).value().empty());
  CHECK(shared_normals(mesh, {{}, {}, std::vector<int>(6, Shading::unsaid)}).value().empty());
  CHECK(shared_normals(mesh, {{}, {}, std::vector<int>(6, 7)}).value().empty());
  const std::vector<int> two_groups = shared_normals(mesh, {{}, {}, {1, 2, 1, 1, 1, 1}}).value();
  REQUIRE(two_groups.size() == 24);
  CHECK(two_groups[0] == two_groups[8]);   // both of group 1 at vertex 0
  CHECK(two_groups[4] != two_groups[11]);  // 2 and 1 at vertex 4
}
