#include "pliant/body/triangle_body.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "body/sheets.hpp"
#include "pliant/body/grid_body.hpp"
#include "pliant/plate/vibration.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/sanitized.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

SampledForce load_on(const Vector3d& center, double deformation_radius, double force_radius,
                     double magnitude = 1) {
  return {PointForce{center, {0, 1, 0}}, magnitude, deformation_radius, force_radius,
          Falloff::Constant};
}

BodyInputs static_inputs(std::vector<SampledForce> forces) {
  BodyInputs in;
  in.dynamics = {0, 0};
  in.frame_length = 1;
  in.dt = 1;
  in.forces = std::move(forces);
  return in;
}

BodyInputs moving_inputs(std::vector<SampledForce> forces) {
  BodyInputs in = static_inputs(std::move(forces));
  in.dynamics = {0.01, 0.05};
  in.frame_length = 1.0 / 24;
  in.dt = 0.01;
  return in;
}

constexpr BodySettings at_rest_measured = {.measure = Measure::Rest};

TriangleBody body_of(const Mesh& mesh, const MeshReading& reading = {},
                     const BodySettings& settings = at_rest_measured) {
  return TriangleBody(std::make_shared<TriangleSurface>(make_surface(mesh, reading).value()),
                      settings);
}

constexpr std::array<double, 2> one = {1, 1};

double height_at_middle(const Body& body) {
  Eigen::Index node = 0;
  body.rest().rowwise().squaredNorm().minCoeff(&node);
  return body.state().positions(node, 1) - body.rest()(node, 1);
}

// The peak of a settled body under a load everywhere.
double settled_peak(const Mesh& mesh, double radius) {
  TriangleBody body = body_of(mesh, {.unit = one});
  REQUIRE(body.step(static_inputs({load_on({0, 0, 0}, radius, 50)})));
  return peak_of(body);
}

Field way_of(const Body& body) { return body.state().positions - body.rest(); }

}  // namespace

TEST_CASE("a disc cut from any mesh has the deflection of a clamped disc", "[body][surface]") {
  // Timoshenko & Woinowsky-Krieger, Theory of Plates and Shells, art. 16.
  constexpr double radius = 0.437;
  const double exact = std::pow(radius, 4) / 64;
  for (const bool has_quads : {false, true}) {
    std::vector<double> errors;
    for (const int count : {23, 46, 92}) {
      if (is_sanitized && count > 23) continue;
      errors.push_back(
          std::abs(settled_peak(square(count, 1, 0.3, has_quads), radius) / exact - 1));
    }
    CHECK(errors[0] < 0.05);  // 20 nodes across
    if (is_sanitized) continue;
    CHECK(errors[1] < errors[0] / 1.8);
    CHECK(errors[2] < errors[0] / 9);
  }
}

TEST_CASE("a clamped square has the deflection of the literature", "[body][surface]") {
  if (is_sanitized) return;  // its figures are what it is about
  CHECK(settled_peak(square(32, 1, 0), 9) == Approx(0.00126532).epsilon(0.02));
  CHECK(settled_peak(square(32, 1, 0, true), 9) == Approx(0.00126532).epsilon(0.01));
  CHECK(settled_peak(square(64, 1, 0.3), 9) == Approx(0.00126532).epsilon(0.006));
}

TEST_CASE("a poked sphere dents as the equation of its meridian says", "[body][surface]") {
  // Clamped caps of the unit sphere under a load of radius 0.3.
  for (const auto& [radius, exact] : {std::pair(0.8, 0.0031619), std::pair(1.5, 0.02086)}) {
    double before = 1;
    for (const int levels : {3, 4}) {
      if (is_sanitized && levels > 3) continue;
      const Mesh mesh = sphere(levels);
      TriangleBody body = body_of(mesh, {.unit = one});
      const Vector3d pole = mesh.positions.row(0).transpose();
      REQUIRE(
          body.step(static_inputs({{PointForce{pole, pole}, 1, radius, 0.3, Falloff::Constant}})));
      const double error = std::abs(way_of(body).row(0).norm() / exact - 1);
      CHECK(error < 0.02);
      CHECK(error < before);
      before = error;
    }
  }
}

TEST_CASE("slopes all round a disc make a round bump", "[body][surface]") {
  if (is_sanitized) return;
  constexpr double radius = 0.4, slope = 0.3;
  for (const double unit : {1.0, 2.0}) {
    TriangleBody body = body_of(square(60, 1, 0.3), {.unit = std::array{unit, unit}});
    BodyInputs in = static_inputs({load_on({0, 0, 0}, radius, 0)});
    in.tangents = {{0, -slope, 0}, {0, slope, 0}, {0, -slope, 0}, {0, slope, 0}};
    REQUIRE(body.step(in));
    CHECK(height_at_middle(body) == Approx(-slope * radius / (2 * unit)).epsilon(0.005));
  }
}

TEST_CASE("the unit carries a grid's numbers over to its remesh", "[body][surface]") {
  if (is_sanitized) return;
  // A sheet of 2 x 3 over [0,1] x [0,1], whole, with b, c, d that differ.
  const auto grid = find_grid(make_mesh({.columns = 65, .rows = 65, .width = 2, .depth = 3}));
  GridBody sheet(grid->grid, grid->rest, at_rest_measured);
  Mesh mesh = square(64, 1, 0.25);
  mesh.positions.col(0) *= 2;
  mesh.positions.col(2) *= 3;
  TriangleBody remesh =
      body_of(mesh, {.unit = std::array{2.0, 3.0}, .axis = std::array{1.0, 0.0, 0.0}});
  BodyInputs in = static_inputs({load_on({0, 0, 0}, 9, 9)});
  in.stiffness = {1.5, 0.7, 0.4};
  REQUIRE(sheet.step(in));
  REQUIRE(remesh.step(in));
  CHECK(peak_of(remesh) == Approx(peak_of(sheet)).epsilon(0.006));
}

TEST_CASE("b and d change places with an axis turned by 90 degrees", "[body][surface]") {
  const Mesh mesh = square(20, 1, 0.3);
  BodyInputs in = static_inputs({load_on({0.1, 0, 0}, 0.35, 0.2)});
  in.stiffness = {2, 1, 0.5};
  in.tangents = {{0, 0.1, 0}, {0, 0.2, 0}, {0, -0.3, 0}, {0, 0.4, 0}};
  TriangleBody along_x = body_of(mesh, {.axis = std::array{1.0, 0.0, 0.0}});
  REQUIRE(along_x.step(in));
  // v = n x u: with u along z and n up, v runs along x.
  TriangleBody along_z = body_of(mesh, {.axis = std::array{0.0, 0.0, 1.0}});
  std::swap(in.stiffness.b, in.stiffness.d);
  std::swap(in.tangents.sv0, in.tangents.su0);
  std::swap(in.tangents.sv1, in.tangents.su1);
  // With u along x, v runs along -z.
  std::swap(in.tangents.su0, in.tangents.su1);
  for (Vector3d* tangent : {&in.tangents.su0, &in.tangents.su1}) *tangent = -*tangent;
  REQUIRE(along_z.step(in));
  CHECK((way_of(along_x) - way_of(along_z)).norm() < 1e-10 * way_of(along_x).norm());
}

TEST_CASE("no order of vertices, seam or rigid motion changes the answer", "[body][surface]") {
  const Mesh mesh = sphere(3);
  const Vector3d pole = mesh.positions.row(0).transpose();
  const SampledForce force{PointForce{pole, {0.3, 1, 0.2}}, 1, 0.9, 0.4, Falloff::Linear};
  TriangleBody body = body_of(mesh);
  for (int frame = 0; frame < 5; ++frame) REQUIRE(body.step(moving_inputs({force})));
  const Field expected = way_of(body);
  const double peak = peak_of(body);
  std::mt19937 random(5);

  SECTION("another order of the vertices, and of the faces") {
    std::vector<int> order(static_cast<std::size_t>(mesh.vertex_count()));
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), random);
    std::vector<std::vector<int>> faces;
    for (std::size_t k = 0; k < mesh.corner_vertices.size(); k += 3) {
      faces.push_back({order[mesh.corner_vertices[k]], order[mesh.corner_vertices[k + 1]],
                       order[mesh.corner_vertices[k + 2]]});
    }
    std::shuffle(faces.begin(), faces.end(), random);
    std::vector<Vector3d> positions(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
      positions[order[k]] = mesh.positions.row(static_cast<Eigen::Index>(k)).transpose();
    }
    TriangleBody other = body_of(mesh_of(positions, faces));
    for (int frame = 0; frame < 5; ++frame) REQUIRE(other.step(moving_inputs({force})));
    for (std::size_t k = 0; k < order.size(); ++k) {
      CHECK((way_of(other).row(order[k]) - expected.row(static_cast<Eigen::Index>(k))).norm() <
            1e-8 * peak);
    }
  }
  SECTION("every face by itself, joined at seams") {
    std::vector<Vector3d> positions;
    std::vector<std::vector<int>> faces;
    for (std::size_t k = 0; k < mesh.corner_vertices.size(); k += 3) {
      faces.emplace_back();
      for (std::size_t n = 0; n < 3; ++n) {
        faces.back().push_back(static_cast<int>(positions.size()));
        positions.push_back(mesh.positions.row(mesh.corner_vertices[k + n]).transpose());
      }
    }
    TriangleBody other = body_of(mesh_of(positions, faces));
    for (int frame = 0; frame < 5; ++frame) REQUIRE(other.step(moving_inputs({force})));
    REQUIRE(other.rest().rows() == mesh.vertex_count());
    for (std::size_t k = 0; k < positions.size(); ++k) {
      const int node = other.surface().vertex_nodes[k];
      CHECK((way_of(other).row(node) - expected.row(mesh.corner_vertices[k])).norm() < 1e-8 * peak);
    }
  }
  SECTION("moved and turned, the force with it") {
    const Transform motion = make_transform({3, -2, 5}, {30, 50, -20}, {1, 1, 1}, RotateOrder::Xyz);
    Mesh moved = mesh;
    moved.positions = to_world(motion, mesh.positions);
    SampledForce its = force;
    its.kind = PointForce{to_world(motion, pole), motion.linear * Vector3d(0.3, 1, 0.2)};
    TriangleBody other = body_of(moved);
    for (int frame = 0; frame < 5; ++frame) REQUIRE(other.step(moving_inputs({its})));
    const Field back = way_of(other) * motion.linear;
    CHECK((back - expected).rowwise().norm().maxCoeff() < 1e-8 * peak);
  }
  SECTION("moved and turned by its transform") {
    BodyInputs in = moving_inputs({force});
    in.transform = make_transform({3, -2, 5}, {30, 50, -20}, {1, 1, 1}, RotateOrder::Xyz);
    in.forces[0].kind =
        PointForce{to_world(in.transform, pole), in.transform.linear * Vector3d(0.3, 1, 0.2)};
    TriangleBody other = body_of(mesh);
    for (int frame = 0; frame < 5; ++frame) REQUIRE(other.step(in));
    CHECK((way_of(other) - expected).rowwise().norm().maxCoeff() < 1e-8 * peak);
  }
}

TEST_CASE("two loads together move as much as one after the other", "[body][surface]") {
  const Mesh mesh = square(16, 1, 0.3, true);
  const auto response = [&](double left, double right) {
    TriangleBody body = body_of(mesh);
    for (int frame = 0; frame < 4; ++frame) {
      REQUIRE(body.step(moving_inputs(
          {load_on({-0.1, 0, 0}, 0.3, 0.2, left), load_on({0.1, 0, 0.1}, 0.3, 0.2, right)})));
    }
    return way_of(body);
  };
  const Field sum = response(3, 0) + response(0, -2), both = response(3, -2);
  CHECK((sum - both).norm() < 1e-11 * both.norm());
}

TEST_CASE("what is outside the region does not move, to the bit", "[body][surface]") {
  TriangleBody body = body_of(square(20, 1, 0.3));
  for (int frame = 0; frame < 5; ++frame) {
    REQUIRE(body.step(moving_inputs({load_on({0.1, 0, 0.05}, 0.25, 0.2)})));
  }
  int moved = 0;
  for (int node = 0; node < body.rest().rows(); ++node) {
    const double apart = (body.rest().row(node) - Eigen::RowVector3d(0.1, 0, 0.05)).norm();
    const bool is_at_rest = body.state().positions.row(node) == body.rest().row(node);
    if (apart >= 0.25) CHECK(is_at_rest);
    moved += is_at_rest ? 0 : 1;
  }
  CHECK(moved > 50);
  CHECK(moved == body.last_step().unknown_count());
}

TEST_CASE("a patch that nothing holds does not move", "[body][surface]") {
  TriangleBody body = body_of(sphere(2));
  REQUIRE(body.step(moving_inputs({load_on({0, 0, 0}, 5, 5)})));
  CHECK_FALSE(body.last_step().solves());
  CHECK(peak_of(body) == 0);
}

TEST_CASE("a force between the nodes of a coarse mesh is told from one that is far away",
          "[body][surface]") {
  const TriangleBody body = body_of(square(4, 1, 0));
  const auto is_near = [&](const Vector3d& center) {
    const StepPlan plan = body.look(moving_inputs({load_on(center, 0.01, 0.01)})).value();
    CHECK_FALSE(plan.selects());
    return plan.surface->forces[0].is_near;
  };
  CHECK(is_near({0.12, 0, 0.1}));
  CHECK(is_near({-0.37, 0.009, 0.4}));
  CHECK_FALSE(is_near({-0.37, 0.011, 0.4}));  // above a face
  CHECK_FALSE(is_near({0.12, 0.9, 0.1}));
  CHECK_FALSE(is_near({0.52, 0, 0.1}));  // beside the border
  CHECK_FALSE(is_near({2, 0, 0}));
}

TEST_CASE("a pinned square has the deflection and the vibration of the literature",
          "[body][surface]") {
  if (is_sanitized) return;
  // Timoshenko & Woinowsky-Krieger: 0.00406 q; clamped it is 0.00126 q.
  const Mesh mesh = square(40, 1, 0.2, true);
  TriangleBody body =
      body_of(mesh, {.unit = one}, {.measure = Measure::Rest, .border = Border::Pinned});
  REQUIRE(body.step(static_inputs({load_on({0, 0, 0}, 9, 9)})));
  CHECK(peak_of(body) == Approx(0.00406235).epsilon(0.01));
  const auto first = [&](const TriangleBody& of) {
    const TrianglePatch& patch = of.last_step().surface->patches.at(0);
    TrianglePlate plate(patch.cells, patch.masses, available_solvers().front(), {});
    const Bending bending = bending_of(static_inputs({}), of.surface().unit, of.settings().border);
    return std::sqrt(smallest_eigenvalue(vibrating(plate, bending).value()).value());
  };
  CHECK(first(body) == Approx(19.739).epsilon(0.005));
  TriangleBody clamped = body_of(mesh, {.unit = one});
  REQUIRE(clamped.step(static_inputs({load_on({0, 0, 0}, 9, 9)})));
  CHECK(first(clamped) == Approx(35.985).epsilon(0.005));
}

TEST_CASE("a free border bends by Poisson's ratio", "[body][surface]") {
  // Half a disc, whose diameter is the border.
  const Mesh mesh = square(24, 1, 0, true);
  const auto peak_with = [&](double poisson) {
    TriangleBody body =
        body_of(mesh, {.unit = one}, {.measure = Measure::Rest, .border = Border::Free});
    BodyInputs in = static_inputs({load_on({0.5, 0, 0}, 0.45, 9)});
    in.poisson = poisson;
    REQUIRE(body.step(in));
    return peak_of(body);
  };
  const double none = peak_with(0), some = peak_with(0.3);
  CHECK(std::abs(some / none - 1) > 0.01);
  CHECK(none > 1.2 * settled_peak(mesh, 0.45));  // half a disc with a free diameter gives way
}

TEST_CASE("the factor stays while the region does", "[body][surface]") {
  TriangleBody body = body_of(square(16, 1, 0.3));
  const auto poke = [](double x, double magnitude) {
    return moving_inputs({load_on({x, 0, 0}, 0.3, 0.2, magnitude)});
  };
  for (int frame = 0; frame < 4; ++frame) REQUIRE(body.step(poke(0, frame)));
  CHECK(body.solver_counts().analyses == 1);
  CHECK(body.solver_counts().factorizations == 1);
  REQUIRE(body.step(poke(0.01, 3)));
  CHECK(body.solver_counts().factorizations == 2);
  // A state restored in between gives the same bits with a new factor.
  TriangleBody other = body_of(square(16, 1, 0.3));
  other.restore(body.state());
  REQUIRE(body.step(poke(0.01, 5)));
  REQUIRE(other.step(poke(0.01, 5)));
  CHECK(body.state() == other.state());
}

TEST_CASE("a badly conditioned plate takes the same steps together and one by one",
          "[body][surface]") {
  // Faces 3000 times as long as wide: a plain solve errs by 5e-9 of the peak, so solutions are
  // corrected: from the steps before, but afresh at a frame's first step.
  Mesh mesh = square(is_sanitized ? 16 : 80, 1, 0.3);
  mesh.positions.col(0) *= 3000;
  const MeshReading reading{.unit = one};
  BodyInputs in = moving_inputs({load_on({0, 0, 0}, 1e6, 1e4)});
  in.dynamics = {1e-9, 1e-9};
  in.frame_length = 0.4;
  in.dt = 0.4 / 12;
  TriangleBody together = body_of(mesh, reading);
  REQUIRE(together.step(in));
  REQUIRE(together.last_step().steps.count == 12);
  in.frame_length /= 12;
  // In the reverse order of vertices, so that everything is rounded differently.
  mesh.positions = mesh.positions.colwise().reverse().eval();
  for (int& vertex : mesh.corner_vertices) vertex = mesh.vertex_count() - 1 - vertex;
  TriangleBody one_by_one = body_of(mesh, reading);
  for (int k = 0; k < 12; ++k) REQUIRE(one_by_one.step(in));
  const double peak = peak_of(together);
  REQUIRE(peak > 0);
  const auto away = [&](const Field& a, const Field& b) { return (a - b).cwiseAbs().maxCoeff(); };
  const Field reversed = one_by_one.state().positions.colwise().reverse();
  CHECK(away(together.state().positions, reversed) < 5e-10 * peak);
}

TEST_CASE("a released surface comes back to rest, all of it", "[body][surface]") {
  TriangleBody body =
      body_of(square(16, 1, 0.3), {}, {.measure = Measure::Rest, .release = Release::Recover});
  BodyInputs in = moving_inputs({load_on({-0.15, 0, 0}, 0.25, 0.2, 50)});
  in.dynamics = {1, 40};
  for (int frame = 0; frame < 5; ++frame) REQUIRE(body.step(in));
  const double pushed = peak_of(body);
  CHECK(pushed > 1e-4);
  in.forces = {load_on({0.2, 0, 0}, 0.2, 0.1, 0)};  // the force has moved on
  REQUIRE(body.step(in));
  CHECK_FALSE(body.last_step().recovering.empty());
  in.forces.clear();
  int frames = 0;
  while (peak_of(body) > 0 && frames < 500) {
    REQUIRE(body.step(in));
    ++frames;
  }
  CHECK(peak_of(body) == 0);
  CHECK(body.state().velocities.isZero(0));
  CHECK(frames > 3);
}

TEST_CASE("a patch that nothing held for a while still comes back to rest", "[body][surface]") {
  // Beside a sheet, which moves all the time.
  Mesh mesh = square(16, 4, 0.3);
  const int first = static_cast<int>(mesh.positions.rows());
  const Mesh ball = sphere(2);
  mesh.positions.conservativeResize(first + ball.positions.rows(), 3);
  mesh.positions.bottomRows(ball.positions.rows()) =
      ball.positions.rowwise() + Eigen::RowVector3d(0, 1.5, 0);
  mesh.face_sizes.insert(mesh.face_sizes.end(), ball.face_sizes.begin(), ball.face_sizes.end());
  for (const int vertex : ball.corner_vertices) mesh.corner_vertices.push_back(first + vertex);
  mesh.corner_uvs.assign(mesh.corner_vertices.size(), -1);
  TriangleBody body = body_of(mesh, {}, {.measure = Measure::Rest, .release = Release::Recover});
  const auto ball_peak = [&] { return way_of(body).bottomRows(ball.positions.rows()).norm(); };

  BodyInputs in = moving_inputs({load_on({0, 2.5, 0}, 0.8, 0.5, 5000), load_on({0, 0, 0}, 1, 0.5)});
  in.dynamics = {1, 4000};
  REQUIRE(body.step(in));
  const double pushed = ball_peak();
  REQUIRE(pushed > 1e-4);
  in.forces[0].deformation_radius = 2.6;  // all of the ball
  REQUIRE(body.step(in));
  CHECK(body.last_step().solves());
  CHECK(ball_peak() == pushed);
  in.forces.erase(in.forces.begin());
  REQUIRE(body.step(in));
  CHECK_FALSE(body.last_step().recovering.empty());
  CHECK(ball_peak() > 0.1 * pushed);
  for (int frame = 0; frame < 500 && ball_peak() > 0; ++frame) REQUIRE(body.step(in));
  CHECK(ball_peak() == 0);
}

TEST_CASE("a frozen node stays where the region left it, and holds its rim", "[body][surface]") {
  TriangleBody body = body_of(square(16, 1, 0.3));
  BodyInputs in = moving_inputs({load_on({-0.1, 0, 0}, 0.3, 0.2, 50)});
  for (int frame = 0; frame < 5; ++frame) REQUIRE(body.step(in));
  const Field before = way_of(body);
  in.forces = {load_on({0.1, 0, 0}, 0.3, 0.2, 0)};
  for (int frame = 0; frame < 50; ++frame) REQUIRE(body.step(in));
  int frozen = 0;
  for (int node = 0; node < before.rows(); ++node) {
    const double apart = (body.rest().row(node) - Eigen::RowVector3d(0.1, 0, 0)).norm();
    if (apart < 0.3) continue;
    CHECK(way_of(body).row(node) == before.row(node));
    frozen += before.row(node).isZero(0) ? 0 : 1;
  }
  CHECK(frozen > 10);
  // The rim is not at rest, so neither is what it holds.
  Eigen::Index near = 0;
  (body.rest().rowwise() - Eigen::RowVector3d(-0.15, 0, 0)).rowwise().squaredNorm().minCoeff(&near);
  CHECK(way_of(body).row(near).norm() > 0.1 * before.rowwise().norm().maxCoeff());
}
