// Surfaces whose vertices are not their nodes: nets, cages, and those that another one drives.

#include <algorithm>
#include <string>

#include "pliant/mesh/written/subdivision.hpp"
#include "pliant/simulation/simulation.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/scenes.hpp"

namespace pliant::testing {
namespace {

// The control points of a sheet of 13 x 13 vertices as a net.
NurbsNet net_of_sheet(int degree) {
  NurbsNet net{.u = {.count = 13, .degree = degree}, .v = {.count = 13, .degree = degree}};
  net.points = make_mesh(std::get<GridSheet>(sheet("s").shape)).positions;
  return net;
}

Surface with_shape(Surface surface, SurfaceShape shape) {
  surface.shape = std::move(shape);
  return surface;
}

Surface driven(const std::string& name, const std::string& driver, SurfaceShape shape) {
  return {.name = name, .driven_by = driver, .shape = std::move(shape)};
}

double largest(const Field& difference) { return difference.cwiseAbs().maxCoeff(); }

TEST_CASE("control points move as the nodes of a grid", "[simulation][nurbs]") {
  const Force force = poke("p", {1, 0, -1});
  const std::vector<Field> grid = baked(scene({sheet("s")}, {force}), "s");
  NurbsNet net = net_of_sheet(1);
  net.u.samples = net.v.samples = 13;  // one at each control point
  const std::vector<Field> same = baked(scene({with_shape(sheet("s"), net)}, {force}), "s");
  CHECK(largest(grid.back() - grid.front()) > 0.1);
  for (std::size_t k = 0; k < grid.size(); ++k) CHECK(largest(same[k] - grid[k]) < 1e-12);

  // Of a higher degree: what is written is the surface of the control points.
  const NurbsNet smooth = net_of_sheet(3);
  auto simulation = Simulation::make(scene({with_shape(sheet("s"), smooth)}, {force})).value();
  const Frame first = simulation.at(1).value(), last = simulation.at(12).value();
  const double peak = last.surfaces()[0].peak_displacement();
  CHECK(peak < largest(grid.back() - grid.front()));
  CHECK_THAT(peak, Catch::Matchers::WithinRel(
                       (last.surfaces()[0].positions() - first.surfaces()[0].positions())
                           .rowwise()
                           .norm()
                           .maxCoeff(),
                       1e-12));
  CHECK(first.surfaces()[0].positions().rows() == 81 * 81);
}

TEST_CASE("a cage moves as the mesh that it is", "[simulation][subdivision]") {
  if (!has_opensubdiv()) return;
  Surface cage{.name = "s", .shape = sphere(1)};
  cage.material.density = 0.001;
  Scene s = scene({cage}, {poke("p", {0, 1, 0}, 100)});
  s.forces[0].deformation_radius = 1.2;
  const std::vector<Field> plain = baked(s, "s");
  CHECK(largest(plain.back() - plain.front()) > 0.01);
  s.surfaces[0].subdivision = Subdivision{.levels = 0};
  CHECK(baked(s, "s") == plain);
  s.surfaces[0].subdivision = Subdivision{.levels = 2, .scheme = SubdivisionScheme::Loop};
  const std::vector<Field> refined = baked(s, "s");
  CHECK(refined.front().rows() == 10 * 16 * 4 + 2);
  // What is far from the force stays, to the bit.
  int still = 0;
  for (Eigen::Index k = 0; k < refined.front().rows(); ++k)
    still += refined.front().row(k) == refined.back().row(k) ? 1 : 0;
  CHECK(still > 100);
  CHECK(still < refined.front().rows());
}

TEST_CASE("a cage that is a grid is refined", "[simulation][subdivision]") {
  if (!has_opensubdiv()) return;
  Surface cage =
      with_shape(sheet("s"), make_mesh({.columns = 13, .rows = 13, .width = 12, .depth = 12}));
  cage.subdivision = Subdivision{.levels = 1};
  auto simulation = Simulation::make(scene({cage}, {poke("p", {0, 0, 0})})).value();
  const RestShape& shape = simulation.rest_shapes()[0];
  CHECK(shape.grid);
  CHECK(shape.mesh.vertex_count() == 25 * 25);
  // Where three and more nodes in a row move alike, so do the vertices between them.
  const Field moved = shape.to_vertices(shape.rest.array() + 0.25);
  CHECK(largest(moved - shape.mesh.positions - Field::Constant(25 * 25, 3, 0.25)) < 1e-14);
}

TEST_CASE("a mesh that is its driver's moves as the driver", "[simulation][driven]") {
  const SurfaceShape shapes[] = {std::get<GridSheet>(sheet("s").shape),
                                 make_mesh(std::get<GridSheet>(sheet("s").shape)),
                                 square(12, 12, 0.3), net_of_sheet(1)};
  for (const SurfaceShape& shape : shapes) {
    CAPTURE(shape.index());
    Surface cage = with_shape(sheet("cage"), shape);
    cage.material.density = 0.01;
    cage.transform.rotate = Value<3>{0, 30, 10};
    Surface skin = driven("skin", "cage", shape);
    if (auto* const net = std::get_if<NurbsNet>(&skin.shape)) net->u.samples = net->v.samples = 13;
    skin.transform = cage.transform;
    Scene s = scene({skin, cage}, {poke("p", {1, 0, -1}, 1)});
    if (std::holds_alternative<NurbsNet>(shape)) {
      auto& net = std::get<NurbsNet>(s.surfaces[1].shape);
      net.u.samples = net.v.samples = 13;
    }
    const std::vector<Field> leads = baked(s, "cage"), follows = baked(s, "skin");
    const double peak = largest(leads.back() - leads.front());
    CHECK(peak > 0);
    for (std::size_t k = 0; k < leads.size(); ++k)
      CHECK(largest(leads[k] - follows[k]) < 1e-12 * (1 + peak));
    std::ranges::reverse(s.surfaces);
    CHECK(baked(s, "skin") == follows);
  }
}

TEST_CASE("a displacement goes through both transforms", "[simulation][driven]") {
  Surface cage = sheet("cage");
  cage.transform.rotate = vector_curve({{1, {0, 0, 0}}, {12, {0, 70, 20}}});
  Surface skin =
      driven("skin", "cage", GridSheet{.columns = 25, .rows = 25, .width = 3, .depth = 3});
  skin.transform.scale = Value<3>{2, 1, -2};
  skin.transform.translate = vector_curve({{1, {0.25, 0.5, 0}}, {12, {9, 9, 9}}});
  auto simulation = Simulation::make(scene({cage, skin}, {poke("p", {0, 0, 0})})).value();
  const Field rest = simulation.at(1).value().surfaces()[1].object_positions();
  const Frame frame = simulation.at(9).value();
  const SurfaceFrame& led = frame.surfaces()[0];
  const SurfaceFrame& follower = frame.surfaces()[1];
  // Over the middle of the driver all nodes are in one quad or more; the vertex that lies above the
  // node at (1,0,0) of the driver has (0.25 + 2 x, 0.5, -2 z) = (1, 0.5, 0).
  const int node = 6 * 13 + 7, vertex = 12 * 25 + 15;
  REQUIRE(simulation.rest_shapes()[0].rest.row(node) == Eigen::RowVector3d(1, 0, 0));
  REQUIRE(rest.row(vertex) == Eigen::RowVector3d(0.375, 0, 0));
  const Vector3d w =
      (led.object_positions().row(node) - simulation.rest_shapes()[0].rest.row(node)).transpose();
  REQUIRE(w.norm() > 0.1);
  const Vector3d own = (follower.object_positions().row(vertex) - rest.row(vertex)).transpose();
  CHECK((follower.transform().linear * own - led.transform().linear * w).norm() < 1e-13 * w.norm());
  CHECK(follower.peak_displacement() > 0.1);
}

TEST_CASE("forces act on drivers only, and threads change no bit",
          "[simulation][driven][threads]") {
  const Surface skin = driven("skin", "cage", sphere(3));
  Scene s = scene({sheet("cage"), skin}, {poke("p", {0, 0, 0})});
  CHECK(Simulation::check(s));
  std::vector<Field> single;
  for (const int threads : {1, 3}) {
    auto simulation = Simulation::make(s, {.threads = threads}).value();
    std::vector<Field> frames;
    for (const int frame : simulation.frames()) {
      frames.push_back(simulation.at(frame).value().surface("skin").positions());
      const auto report = simulation.report(frame).value();
      CHECK(report.surfaces[0].forces.size() == 1);
      CHECK(report.surfaces[1].forces.empty());
      CHECK_FALSE(report.surfaces[1].is_solved);
    }
    for (const Warning& warning : simulation.warnings()) CHECK(warning.surface != "skin");
    if (threads == 1) single = frames;
    CHECK(frames == single);
  }
  CHECK(largest(single.back() - single.front()) > 0.1);
  // Any order of frames, and a disabled driver.
  auto simulation = Simulation::make(s).value();
  CHECK(simulation.at(12).value().surface("skin").positions() == single[11]);
  CHECK(simulation.at(5).value().surface("skin").positions() == single[4]);
  s.surfaces[0].enabled = false;
  const std::vector<Field> still = baked(s, "skin");
  CHECK(still.back() == still.front());
  s.surfaces[0].enabled = true;
  s.surfaces[1].enabled = false;
  CHECK(baked(s, "skin").back() == still.front());
}

TEST_CASE("nets, cages and bindings reserve their memory first", "[simulation][driven]") {
  NurbsNet net = net_of_sheet(3);
  net.u.samples = net.v.samples = 9000;  // 81 million vertices
  Surface cage{.name = "s", .shape = sphere(1)};
  cage.subdivision = Subdivision{.levels = 6};
  for (const Scene& s :
       {scene({with_shape(sheet("s"), net)}, {}), scene({cage}, {}),
        scene({sheet("cage"), driven("s", "cage", GridSheet{.columns = 2000, .rows = 2000})},
              {})}) {
    if (s.surfaces[0].subdivision && !has_opensubdiv()) continue;
    const auto refused = Simulation::make(s, {.max_memory = 20'000'000});
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::OutOfMemory);
    CHECK_THAT(refused.error().message, contains_text("surface \"s\""));
  }
}

}  // namespace
}  // namespace pliant::testing
