#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

#include "pliant/body/triangle_body.hpp"
#include "pliant/plate/vibration.hpp"
#include "support/catch.hpp"
#include "support/dense.hpp"
#include "support/meshes.hpp"
#include "support/sanitized.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

constexpr std::array<double, 2> unit_lengths = {1, 1};

// The smallest eigenvalue of each patch of a whole surface that has no or another border, beside
// that of the full matrices, of which the first ones are rigid.
void check_patches(const Mesh& mesh, Border border, int rigid_count, double tolerance) {
  const TriangleBody body(
      std::make_shared<TriangleSurface>(make_surface(mesh, {.unit = unit_lengths}).value()),
      {.measure = Measure::Rest, .region = SolvedRegion::All, .border = border});
  BodyInputs inputs;
  inputs.stiffness = {1.5, 2, 1};
  inputs.frame_length = inputs.dt = 1;
  const StepPlan plan = body.look(inputs).value();
  REQUIRE_FALSE(plan.surface->patches.empty());
  for (const TrianglePatch& patch : plan.surface->patches) {
    TrianglePlate plate(patch.cells, patch.masses, available_solvers().front(), {});
    const Bending bending = bending_of(inputs, body.surface().unit, border);
    const Eigen::MatrixXd upper = plate.stiffness(bending).value();
    const Eigen::MatrixXd full = upper.selfadjointView<Eigen::Upper>();
    // Without the slopes, which have no mass.
    const auto nodes = static_cast<Eigen::Index>(patch.masses.size());
    const Eigen::Index slopes = full.rows() - nodes;
    const Eigen::MatrixXd stiffness =
        full.topLeftCorner(nodes, nodes) -
        full.topRightCorner(nodes, slopes) * full.bottomRightCorner(slopes, slopes)
                                                 .ldlt()
                                                 .solve(full.bottomLeftCorner(slopes, nodes));
    const Eigen::Map<const Eigen::VectorXd> masses(patch.masses.data(), nodes);
    const Eigen::VectorXd all = modes_of(stiffness, masses.asDiagonal()).values;
    const double expected = all(rigid_count);
    CAPTURE(nodes, rigid_count, all.head(rigid_count + 2).transpose());
    if (rigid_count > 0) REQUIRE(all(rigid_count - 1) < 1e-9 * expected);
    CHECK(patch.is_held() == (rigid_count == 0));
    CHECK_THAT(smallest_eigenvalue(plate, bending, patch.is_held()).value(),
               WithinRel(expected, tolerance));
  }
}

// The smallest eigenvalue of a whole surface in one patch that nothing holds.
double smallest_of_free(const Mesh& mesh) {
  const TriangleBody body(
      std::make_shared<TriangleSurface>(make_surface(mesh, {.unit = unit_lengths}).value()),
      {.measure = Measure::Rest, .region = SolvedRegion::All, .border = Border::Free});
  BodyInputs inputs;
  inputs.frame_length = inputs.dt = 1;
  const StepPlan plan = body.look(inputs).value();
  const TrianglePatch& patch = plan.surface->patches.at(0);
  TrianglePlate plate(patch.cells, patch.masses, available_solvers().front(), {});
  return smallest_eigenvalue(plate, bending_of(inputs, unit_lengths, Border::Free), false).value();
}

// A sheet of quads that is rolled round an axis by an angle.
Mesh rolled(int count, double angle) {
  Mesh mesh = square(count, 1, 0.2, true);
  for (Eigen::Index k = 0; k < mesh.positions.rows(); ++k) {
    const double at = angle * mesh.positions(k, 0);
    mesh.positions(k, 0) = std::sin(at) / angle;
    mesh.positions(k, 1) = std::cos(at) / angle;
  }
  return mesh;
}

}  // namespace

TEST_CASE("a held patch vibrates as its full matrix says", "[body][surface][vibration]") {
  check_patches(square(9, 1, 0.2), Border::Clamped, 0, 1e-9);
  check_patches(square(7, 3, 0.2, true), Border::Pinned, 0, 1e-9);
}

TEST_CASE("a floating patch's slowest vibration leaves its rigid motions out",
          "[body][surface][vibration]") {
  check_patches(square(8, 1, 0.2), Border::Free, 3, 1e-8);
  check_patches(square(8, 1, 0, true), Border::Free, 3, 1e-8);
  check_patches(square(6, 1e3, 0.2), Border::Free, 3, 1e-8);
  check_patches(square(6, 1e-3, 0.2), Border::Free, 3, 1e-8);
  check_patches(sphere(1), Border::Clamped, 1, 1e-8);
  check_patches(sphere(2), Border::Free, 1, 1e-8);
  // Two of different sizes.
  Mesh two = square(5, 1, 0.2), other = square(5, 2, 0.1);
  const auto count = static_cast<int>(two.positions.rows());
  Field positions(2 * count, 3);
  positions << two.positions, other.positions.rowwise() + Eigen::RowVector3d(5, 0, 0);
  two.positions = positions;
  for (const int corner : other.corner_vertices) two.corner_vertices.push_back(corner + count);
  two.face_sizes.insert(two.face_sizes.end(), other.face_sizes.begin(), other.face_sizes.end());
  two.corner_uvs.assign(two.corner_vertices.size(), -1);
  check_patches(two, Border::Free, 3, 1e-8);
}

TEST_CASE("a long strip and a tiny one that float", "[body][surface][vibration]") {
  Mesh strip = square(10, 1, 0.1);
  strip.positions.col(0) *= 30;
  check_patches(strip, Border::Free, 3, 1e-8);
}

TEST_CASE("what is nearly flat is not rigid", "[body][surface][vibration]") {
  // A tube sheet unrolls; with a bump of a thousandth it does not quite.
  Mesh bumped = square(6, 1, 0.1);
  for (Eigen::Index k = 0; k < bumped.positions.rows(); ++k) {
    const double x = bumped.positions(k, 0), z = bumped.positions(k, 2);
    bumped.positions(k, 1) = 0.3 * (0.25 - x * x) * (0.25 - z * z);
  }
  check_patches(bumped, Border::Free, 1, 1e-6);
  check_patches(rolled(6, 2), Border::Free, 1, 1e-6);
}

TEST_CASE("a free square vibrates as the literature says", "[body][surface][vibration]") {
  if (is_sanitized) return;  // its figures are what it is about
  // Leissa, The free vibration of rectangular plates (1973), with nu = 0.3.
  CHECK_THAT(std::sqrt(smallest_of_free(square(40, 1, 0, true))), WithinRel(13.468, 5e-3));
}

TEST_CASE("where every motion is rigid, nothing vibrates", "[body][surface][vibration]") {
  CHECK(smallest_of_free(mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {{0, 2, 1}})) == 0);
}
