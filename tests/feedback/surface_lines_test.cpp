#include "pliant/feedback/surface_lines.hpp"

#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "pliant/mesh/written/subdivision.hpp"
#include "pliant/simulation/simulation.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

Simulation simulation_of(SurfaceShape shape) {
  Surface surface = sheet("s");
  surface.shape = std::move(shape);
  return Simulation::make(scene({surface}, {})).value();
}

// The vertices that lines between vertices run along, each edge once.
std::set<std::pair<int, int>> edges_of(const SurfaceLines& lines) {
  std::set<std::pair<int, int>> edges;
  for (const auto& [a, b] : lines.segments) {
    CHECK(edges.insert(std::minmax(lines.sources[a], lines.sources[b])).second);
  }
  return edges;
}

double length_of_lines(const SurfaceLines& lines, const Field& positions) {
  const Field points = lines.points(positions);
  double length = 0;
  for (const auto& [a, b] : lines.segments) length += (points.row(b) - points.row(a)).norm();
  return length;
}

}  // namespace

TEST_CASE("a point may be a sum of earlier points", "[feedback][outline]") {
  SurfaceLines lines;
  lines.add_source(0, 0.5);
  lines.add_source(2, 0.5);
  lines.add_point();
  lines.add_source(-1, 0.25);
  lines.add_source(1, 0.75);
  CHECK(lines.add_point() == 1);
  Field positions(3, 3);
  positions << 0, 0, 0, 4, 8, 0, 8, 0, 16;
  CHECK((lines.points(positions).row(0) == Eigen::RowVector3d(4, 0, 8)));
  CHECK((lines.points(positions).row(1) == Eigen::RowVector3d(4, 6, 2)));
}

TEST_CASE("lines around boxes run along the cells' edges", "[feedback][outline]") {
  const auto simulation = simulation_of(GridSheet{.columns = 9, .rows = 7});
  const LinesOnMesh mesh(simulation.rest_shapes()[0]);
  const auto around = [&](std::vector<Box> boxes) { return edges_of(mesh.around(boxes)); };
  CHECK(around({{2, 5, 1, 3}}).size() == 2 * (3 + 2));
  CHECK(around({{2, 5, 1, 3}}).count({9 + 2, 9 + 3}) == 1);
  // Two that overlap; two with a common side; one beyond the grid; a line; a point.
  CHECK(around({{1, 4, 1, 4}, {3, 6, 2, 5}}).size() == 2 * (5 + 4));
  CHECK(around({{1, 3, 1, 3}, {3, 5, 1, 3}}).size() == 2 * (4 + 2));
  CHECK(around({{-5, 2, -3, 2}}) == around({{0, 2, 0, 2}}));
  CHECK(around({{2, 5, 3, 3}}).size() == 3);
  CHECK(around({{4, 4, 1, 3}}).size() == 2);
  CHECK(around({{4, 4, 3, 3}}).empty());
  CHECK(around({{0, 8, 0, 6}}).size() == 2 * (8 + 6));
}

TEST_CASE("lines around boxes of a closed grid cross its seam", "[feedback][outline]") {
  NurbsNet tube{.u = {.count = 8, .degree = 1, .is_closed = true, .samples = 8},
                .v = {.count = 4, .degree = 1, .samples = 4}};
  tube.points.resize(32, 3);
  for (int k = 0; k < 32; ++k) {
    tube.points.row(k) << std::cos(k % 8 * 0.7853981633974483), k / 8,
        std::sin(k % 8 * 0.7853981633974483);
  }
  const auto simulation = simulation_of(tube);
  const RestShape& shape = simulation.rest_shapes()[0];
  REQUIRE(shape.grid->is_closed_u);
  const LinesOnMesh mesh(shape);
  const double side = 2 * std::sin(0.39269908169872414);
  const auto length = [&](const Box& box) {
    return length_of_lines(mesh.around({&box, 1}), shape.mesh.positions);
  };
  CHECK_THAT(length({6, 9, 1, 2}), Catch::Matchers::WithinRel(6 * side + 2, 1e-9));
  CHECK_THAT(length({3, 10, 1, 2}), Catch::Matchers::WithinRel(16 * side, 1e-9));  // a ring
  CHECK_THAT(length({5, 12, 2, 2}), Catch::Matchers::WithinRel(8 * side, 1e-9));
}

TEST_CASE("lines on a net run along what is written of it", "[feedback][outline]") {
  NurbsNet net{.u = {.count = 7, .degree = 3}, .v = {.count = 6, .degree = 2}};
  net.points = make_mesh(GridSheet{.columns = 7, .rows = 6, .width = 6, .depth = 5}).positions;
  const auto simulation = simulation_of(net);
  const RestShape& shape = simulation.rest_shapes()[0];
  const LinesOnMesh mesh(shape);
  const Box all{0, 6, 0, 5};
  const SurfaceLines border = mesh.around({&all, 1});
  CHECK_THAT(length_of_lines(border, shape.mesh.positions), Catch::Matchers::WithinRel(22, 1e-9));
  // They follow: on a paraboloid, at most as far below it as its triangles are.
  Field bent = shape.mesh.positions;
  bent.col(1) = 0.1 * (bent.col(0).array().square() + bent.col(2).array().square());
  const Box part{2, 4, 1, 3};
  const SurfaceLines lines = mesh.around({&part, 1});
  const Field points = lines.points(bent);
  REQUIRE(points.rows() > 40);
  for (Eigen::Index k = 0; k < points.rows(); ++k) {
    const double height = 0.1 * (points(k, 0) * points(k, 0) + points(k, 2) * points(k, 2));
    CHECK_THAT(points(k, 1), Catch::Matchers::WithinAbs(height, 0.01));
  }
}

TEST_CASE("the outline on a cage is drawn on the subdivided surface", "[feedback][outline]") {
  if (!has_opensubdiv()) return;
  Surface ball{.name = "ball", .shape = sphere(2)};
  ball.subdivision.emplace();
  Force force = poke("p", {0, 1, 0}, 10);
  force.deformation_radius = 0.7;
  force.force_radius = 0.5;
  auto simulation = Simulation::make(scene({ball}, {force}, 4)).value();
  const RestShape& shape = simulation.rest_shapes()[0];
  const SurfaceReport report = simulation.report(1, ReportDetail::Outlines)->surfaces[0];
  REQUIRE(report.outlines.size() == 1);
  CHECK(report.outlines[0].is_solved);
  const LinesOnMesh mesh(shape);
  for (const SurfaceLines& of_nodes : {report.outlines[0].lines, report.forces[0].outline}) {
    const SurfaceLines lines = mesh.to_vertices(of_nodes);
    const Field points = lines.points(shape.mesh.positions);
    CHECK(lines.segments.size() > of_nodes.segments.size());
    const double radius = shape.mesh.positions.rowwise().norm().mean();
    std::map<int, int> ends;
    for (const auto& [a, b] : lines.segments) {
      ++ends[a];
      ++ends[b];
      CHECK_THAT((0.5 * (points.row(a) + points.row(b))).norm(),
                 Catch::Matchers::WithinRel(radius, 0.02));
    }
    for (const auto& [point, count] : ends) CHECK(count % 2 == 0);
  }
}

TEST_CASE("a report has the outline of each patch and of what each force pushes",
          "[feedback][outline][report]") {
  Mesh mesh = sphere(3);
  // A second ball, wholly within the force's sphere.
  const Mesh eye = sphere(1);
  const int count = mesh.vertex_count();
  mesh.positions.conservativeResize(count + eye.vertex_count(), 3);
  mesh.positions.bottomRows(eye.vertex_count()) = 0.05 * eye.positions;
  mesh.positions.bottomRows(eye.vertex_count()).col(1).array() += 1;
  for (const int vertex : eye.corner_vertices) mesh.corner_vertices.push_back(count + vertex);
  mesh.face_sizes.insert(mesh.face_sizes.end(), eye.face_sizes.begin(), eye.face_sizes.end());
  mesh.corner_uvs.resize(mesh.corner_vertices.size(), -1);
  Surface surface{.name = "s", .shape = mesh};
  surface.solver.measure = GENERATE(Measure::Rest, Measure::Current);
  Force force = poke("p", {0, 1, 0}, 50);
  force.deformation_radius = 0.7;
  force.force_radius = 0.4;
  auto simulation = Simulation::make(scene({surface, sheet("grid")}, {force}, 4)).value();
  const SurfaceReport first = simulation.report(1, ReportDetail::Outlines)->surfaces[0];
  REQUIRE(first.outlines.size() == 2);
  CHECK(first.patches.size() == 2);
  const bool is_ball_first = first.patches[0].cells > first.patches[1].cells;
  const PatchOutline& ball = first.outlines[is_ball_first ? 0 : 1];
  const PatchOutline& loose = first.outlines[is_ball_first ? 1 : 0];
  CHECK(ball.is_solved);
  CHECK(ball.lines.segments.size() > 20);
  CHECK_FALSE(loose.is_solved);
  CHECK(loose.lines.segments.empty());
  const SurfaceLines pushed = first.forces.at(0).outline;
  REQUIRE(pushed.segments.size() > 12);
  const Field points = pushed.points(simulation.rest_shapes()[0].rest);
  for (Eigen::Index k = 0; k < points.rows(); ++k) {
    CHECK_THAT((points.row(k) - Eigen::RowVector3d(0, 1, 0)).norm(),
               Catch::Matchers::WithinAbs(0.4, 0.02));
  }
  // It moves only if distances are measured on the moving surface.
  const SurfaceLines later =
      simulation.report(4, ReportDetail::Outlines)->surfaces[0].forces.at(0).outline;
  CHECK((later.shares == pushed.shares) == (surface.solver.measure == Measure::Rest));
  CHECK(simulation.report(4, ReportDetail::Outlines)->surfaces[0].outlines[0].lines.shares ==
        first.outlines[0].lines.shares);
  CHECK(simulation.report(1, ReportDetail::Outlines)->surfaces[1].outlines.empty());
}
