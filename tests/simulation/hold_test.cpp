#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "pliant/scene/read.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/png.hpp"
#include "support/scenes.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

// Held nodes, over whole runs.

namespace {

constexpr Edges no_edges = {Edge::Free, Edge::Free, Edge::Free, Edge::Free};
constexpr Edges pinned_edges = {Edge::Pinned, Edge::Pinned, Edge::Pinned, Edge::Pinned};

Surface plate(int count = 13) {
  Surface surface = light(sheet("s", count));
  surface.solver.edges = no_edges;
  return surface;
}

Mesh mesh_of_shape(const Surface& surface) {
  const auto* const grid = std::get_if<GridSheet>(&surface.shape);
  return grid ? make_mesh(*grid) : std::get<Mesh>(surface.shape);
}

// The vertices at which a property is true.
std::vector<int> where(const Surface& surface, const std::function<bool(const Vector3d&)>& is) {
  const Mesh mesh = mesh_of_shape(surface);
  std::vector<int> found;
  for (int k = 0; k < static_cast<int>(mesh.positions.rows()); ++k)
    if (is(mesh.positions.row(k).transpose())) found.push_back(k);
  return found;
}

Hold hold_of(std::vector<int> vertices) {
  Hold hold;
  hold.vertices = std::move(vertices);
  return hold;
}

Force blow(double magnitude) {
  Force force = poke("blow", {1.3, 0, -0.7}, magnitude);
  force.kind = PointChannels{.center = Value<3>{1.3, 0, -0.7}, .direction = Value<3>{0.2, 1, 0.1}};
  return force;
}

Force even_push(double magnitude) {
  Force force = poke("wind", {});
  force.kind = UniformChannels{};
  force.force_radius = 1e3;
  force.magnitude = magnitude;
  return force;
}

std::string why_not(const Scene& scene) {
  const auto simulation = Simulation::make(scene);
  CHECK(simulation.has_value() == Simulation::check(scene).has_value());
  return simulation ? "" : simulation.error().message;
}

void check_close(const std::vector<Field>& frames, const std::vector<Field>& expected,
                 double bound) {
  CHECK(peak(expected) > 1e-3);
  for (std::size_t k = 0; k < frames.size(); ++k)
    CHECK(largest_difference(frames[k], expected[k]) < bound * peak(expected));
}

}  // namespace

TEST_CASE("holds on the whole border of a free sheet are pinned edges", "[simulation][hold]") {
  for (const Integrator integrator :
       {Integrator::BackwardEuler, Integrator::Newmark, Integrator::Exact}) {
    for (const bool yields : {false, true}) {
      if (yields && integrator == Integrator::Exact) continue;
      Surface pinned = plate();
      pinned.material.c = 2.5;
      pinned.material.poisson = 0.25;
      pinned.solver.integrator = integrator;
      if (yields) pinned.material.yield = 0.4;
      Surface held = pinned;
      pinned.solver.edges = pinned_edges;
      held.holds = {hold_of(where(
          held, [](const Vector3d& p) { return std::abs(p.x()) > 5.5 || std::abs(p.z()) > 5.5; }))};
      check_close(baked(scene({held}, {blow(1)}), "s"), baked(scene({pinned}, {blow(1)}), "s"),
                  1e-10);
    }
  }
}

TEST_CASE("holds on the whole border of a free mesh are a pinned border", "[simulation][hold]") {
  for (const bool has_quads : {false, true}) {
    const Surface pinned = light_skin(square(8, 6, 0.25, has_quads), Border::Pinned);
    Surface held = light_skin(square(8, 6, 0.25, has_quads), Border::Free);
    held.material.poisson = 0.0;
    held.holds = {hold_of(where(
        held, [](const Vector3d& p) { return std::abs(p.x()) > 2.99 || std::abs(p.z()) > 2.99; }))};
    check_close(baked(scene({held}, {blow(1)}), "s"), baked(scene({pinned}, {blow(1)}), "s"),
                1e-10);
  }
}

TEST_CASE("a held node keeps its place to the bit", "[simulation][hold]") {
  Surface local = sheet("s");
  Surface clamped = plate();
  clamped.solver.edges = {};
  Surface recovering = local;
  recovering.solver.release = Release::Recover;
  Surface cut = light_skin(square(12, 10, 0.2), Border::Clamped);
  cut.solver.region = SolvedRegion::Forces;
  Surface moving = plate();
  moving.transform.translate = vector_curve({{1, {0, 0, 0}}, {6, {0, 2, 1}}});
  for (Surface surface :
       {local, clamped, recovering, plate(), moving, cut,
        light_skin(square(8, 10, 0.2), Border::Free), light_skin(sphere(2), Border::Clamped)}) {
    for (const Integrator integrator :
         {Integrator::BackwardEuler, Integrator::Newmark, Integrator::Exact}) {
      surface.solver.integrator = integrator;
      surface.holds = {hold_of({40}), hold_of({27})};
      Force push = blow(surface.solver.region == SolvedRegion::All ? 1 : 3000);
      push.deformation_radius = push.force_radius = 4.5;
      const auto simulation = Simulation::make(scene({surface}, {push}));
      REQUIRE(simulation);
      auto playing = *Simulation::make(scene({surface}, {push}));
      double most = 0;
      const Field rest = playing.at(1).value().surface("s").object_positions();
      for (int frame = 1; frame <= 12; ++frame) {
        const Frame now = playing.at(frame).value();
        const Field& positions = now.surface("s").object_positions();
        CHECK(positions.row(40) == rest.row(40));
        CHECK(positions.row(27) == rest.row(27));
        most = std::max(most, largest_difference(positions, rest));
      }
      CHECK(most > 1e-4);
    }
  }
}

TEST_CASE("a held node is one with an endless goal", "[simulation][hold][goal]") {
  Surface local = sheet("s");
  local.material.density = 0.02;
  local.material.damping = 0.02;
  for (Surface surface : {local, plate(), light_skin(square(8, 10, 0.2), Border::Free)}) {
    std::vector<int> vertices = {40, 41, 27, 66};
    Surface pulled = surface;
    surface.holds = {hold_of(vertices)};
    MaterialMap map{.channel = MapChannel::Goal};
    map.values.resize(static_cast<std::size_t>(mesh_of_shape(pulled).positions.rows()));
    for (const int vertex : vertices) map.values[static_cast<std::size_t>(vertex)] = 1;
    pulled.maps = {map};
    pulled.material.goal = 1e12;
    const Force force = blow(surface.solver.region == SolvedRegion::All ? 1 : 30);
    check_close(baked(scene({surface}, {force}), "s"), baked(scene({pulled}, {force}), "s"), 1e-6);
  }
}

TEST_CASE("a region without a held node inside has the bits of before", "[simulation][hold]") {
  Surface surface = sheet("s");
  const auto expected = baked(scene({surface}, {blow(3000)}), "s");
  surface.holds = {hold_of({0, 1, 168})};
  CHECK(baked(scene({surface}, {blow(3000)}), "s") == expected);
  // On the rim nodes are held anyway.
  surface.solver.region = SolvedRegion::All;
  surface.holds.clear();
  const auto whole = baked(scene({surface}, {blow(3000)}), "s");
  surface.holds = {hold_of({0, 5, 12, 26, 168})};
  CHECK(baked(scene({surface}, {blow(3000)}), "s") == whole);
}

TEST_CASE("what is held everywhere is not solved", "[simulation][hold]") {
  for (Surface surface : {sheet("s"), plate(), light_skin(square(6, 6, 0.2), Border::Free)}) {
    surface.holds = {hold_of(where(surface, [](const Vector3d&) { return true; }))};
    CHECK(peak(baked(scene({surface}, {blow(300)}), "s")) == 0);
  }
}

TEST_CASE("static surfaces need held nodes that are not in one line", "[simulation][hold]") {
  for (Surface surface : {plate(), light_skin(square(12, 12, 0), Border::Free)}) {
    surface.material.density = surface.material.damping = 0;
    const auto with = [&](std::vector<int> vertices) {
      surface.holds = {hold_of(std::move(vertices))};
      return scene({surface}, {even_push(0.01)}, 3);
    };
    for (const auto& line : {std::vector<int>{70}, {14, 28, 56}, {13, 20}})
      CHECK_THAT(why_not(with(line)), Contains("nothing holds") && Contains("<hold>"));
    CHECK(peak(baked(with({14, 28, 50}), "s")) > 1e-3);
    // A goal counts as well.
    Surface both = surface;
    both.holds = {hold_of({14, 28})};
    MaterialMap map{.channel = MapChannel::Goal};
    map.values.resize(169);
    map.values[50] = 1;
    both.maps = {map};
    both.material.goal = 5;
    CHECK(peak(baked(scene({both}, {even_push(0.01)}, 3), "s")) > 1e-3);
    // With a density it swings about what holds it.
    surface.material.density = 0.02;
    CHECK(why_not(with({70})).empty());
  }
}

TEST_CASE("a damping ratio counts with held nodes", "[simulation][hold]") {
  // Held at its border as above: that of a pinned sheet.
  Surface pinned = plate(9);
  pinned.material.damping = MaterialChannels().damping;
  pinned.material.damping_ratio = 0.1;
  Surface held = pinned;
  pinned.solver.edges = pinned_edges;
  held.holds = {hold_of(where(
      held, [](const Vector3d& p) { return std::abs(p.x()) > 3.5 || std::abs(p.z()) > 3.5; }))};
  check_close(baked(scene({held}, {blow(1)}), "s"), baked(scene({pinned}, {blow(1)}), "s"), 1e-7);
}

TEST_CASE("pictures, numbers and attributes hold where they are above", "[simulation][hold]") {
  const ScratchFolder folder;
  // Black on the left half, white on the right.
  PngMaker picture{.width = 2, .height = 1, .values = {0, 255}};
  folder.write("half.png", picture.bytes());
  std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
      "z\nproperty float pin\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 0.2\n1 0 0 0.6\n1 0 1 0.6\n0 0 1 0.1\n4 0 1 2 3\n";
  folder.write("quad.ply", ply);
  const auto scene_of = [&](const std::string& shape, const std::string& hold) {
    const std::string text = fmt::format(
        "<scene start=\"1\" end=\"6\"><surface name=\"s\">{}{}<material density=\"0.1\" "
        "damping=\"0.1\"/><solver region=\"all\"{}/></surface><uniform name=\"w\" "
        "magnitude=\"0.3\" forceRadius=\"99\"/></scene>",
        shape, hold, shape.starts_with("<grid") ? " edges=\"free\"" : "");
    return parse_scene(text, (folder.path() / "scene.xml").string(), folder.path().string());
  };
  const auto moved_of = [&](const std::string& shape, const std::string& hold) {
    const auto scene = scene_of(shape, hold);
    REQUIRE(scene);
    const auto frames = baked(*scene, "s");
    std::vector<bool> moved;
    for (Eigen::Index k = 0; k < frames[0].rows(); ++k)
      moved.push_back(frames.back().row(k) != frames[0].row(k));
    return moved;
  };
  const std::string grid = "<grid columns=\"5\" rows=\"4\"/>";
  const auto by_picture = moved_of(grid, "<hold file=\"half.png\"/>");
  for (int k = 0; k < 20; ++k) CHECK(by_picture[k] == (k % 5 < 3));
  // At u = 1/4, 1/2, 3/4: 0, 1/2, 1.
  const auto lower = moved_of(grid, "<hold file=\"half.png\" above=\"0.4\"/>");
  for (int k = 0; k < 20; ++k) CHECK(lower[k] == (k % 5 < 2));
  const std::string quad = "<mesh file=\"quad.ply\" uv=\"surface\" border=\"free\"/>";
  CHECK(moved_of(quad, "<hold attribute=\"pin\"/>") == std::vector<bool>{true, false, false, true});
  CHECK(moved_of(quad, "<hold attribute=\"pin\" above=\"0.15\"/>") ==
        std::vector<bool>{false, false, false, true});
  CHECK(moved_of(quad, "<hold vertices=\"3\"/><hold attribute=\"pin\"/>") ==
        std::vector<bool>{true, false, false, false});
  const auto refused = [&](const std::string& hold) {
    const auto scene = scene_of(quad, hold);
    if (!scene) return scene.error().message;
    return why_not(*scene);
  };
  CHECK_THAT(refused("<hold attribute=\"pin\" above=\"0.7\"/>"),
             Contains("s.hold.0: no node is above 0.7: the values go from 0.1"));
  CHECK_THAT(refused("<hold vertices=\"1\"/><hold vertices=\"2 4\"/>"),
             Contains("s.hold.1: there is no vertex 4: the surface has 4, from 0 to 3"));
  CHECK_THAT(refused("<hold attribute=\"pinn\"/>"), Contains("pinn") && Contains("pin"));
}

TEST_CASE("a net holds its points", "[simulation][hold]") {
  const auto frames_of = [&](const std::string& hold) {
    const auto scene = parse_scene(
        "<scene start=\"1\" end=\"6\"><surface name=\"s\"><nurbs columns=\"4\" rows=\"4\" "
        "degreeU=\"1\" degreeV=\"1\" samplesU=\"4\" samplesV=\"4\"><points>0 0 0 1 0 0 2 0 0 3 0 0 "
        "0 0 1 1 0 1 2 0 1 3 0 1 0 0 2 1 0 2 2 0 2 3 0 2 0 0 3 1 0 3 2 0 3 3 0 3</points></nurbs>" +
            hold +
            "<solver region=\"all\" edges=\"free\"/></surface><uniform name=\"w\" "
            "magnitude=\"9\" forceRadius=\"99\"/></scene>",
        "scene.xml", "");
    REQUIRE(scene);
    return baked(*scene, "s");
  };
  const auto frames = frames_of("<hold vertices=\"5 15\"/>");
  for (Eigen::Index k = 0; k < 16; ++k)
    CHECK((frames.back().row(k) == frames[0].row(k)) == (k == 5 || k == 15));
}

TEST_CASE("a cage holds its vertices", "[simulation][hold]") {
  Surface cage = light_skin(square(4, 4, 0), Border::Free);
  cage.subdivision.emplace();
  cage.subdivision->levels = 1;
  if (!Simulation::make(scene({cage}, {}))) return;  // a build without OpenSubdiv
  cage.holds = {hold_of({12})};
  const auto frames = baked(scene({cage}, {even_push(0.3)}), "s");
  REQUIRE(frames[0].rows() > 25);
  CHECK(peak(frames) > 1e-3);
  // Its written vertex is a mean of its neighbours too: all of these held, it stays.
  CHECK(frames.back().row(12) != frames[0].row(12));
  cage.holds = {hold_of({6, 7, 8, 11, 12, 13, 16, 17, 18})};
  const auto still = baked(scene({cage}, {even_push(0.3)}), "s");
  CHECK(largest_difference(still.back().row(12), still[0].row(12)) < 1e-12);
  CHECK(peak(still) > 1e-3);
  cage.holds = {hold_of({25})};
  CHECK_THAT(why_not(scene({cage}, {})), Contains("there is no vertex 25: the surface has 25"));
}

TEST_CASE("values of a program hold, and are written to no file", "[simulation][hold]") {
  Surface surface = plate(5);
  Hold hold;
  hold.values.assign(25, 0);
  hold.values[7] = hold.values[11] = 1;
  surface.holds = {hold};
  Surface same = surface;
  same.holds = {hold_of({7, 11})};
  const Scene own = scene({surface}, {blow(1)});
  CHECK(baked(own, "s") == baked(scene({same}, {blow(1)}), "s"));
  const auto text = to_xml(own);
  REQUIRE_FALSE(text);
  CHECK_THAT(text.error().message, Contains("s.hold.0 has values of a program"));
  hold.values.pop_back();
  surface.holds = {hold};
  CHECK_THAT(why_not(scene({surface}, {})), Contains("the hold has 24 values"));
  // Those of vertices are.
  const auto written = to_xml(scene({same}, {blow(1)}));
  REQUIRE(written);
  CHECK_THAT(*written, Contains("<hold vertices=\"7 11\"/>"));
  CHECK(parse_scene(*written, "a.xml", "").value() == scene({same}, {blow(1)}));
}
