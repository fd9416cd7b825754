#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "pliant/scene/checks/check.hpp"
#include "pliant/scene/read.hpp"
#include "pliant/scene/write.hpp"
#include "support/caches.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

// `<grid uv="surface">`: a sheet that is read as a mesh.

namespace {

Surface round_sheet(const GridSheet& sheet) {
  Surface surface;
  surface.name = "s";
  surface.shape = sheet;
  surface.reading.uv = UvReading::Surface;
  surface.material.density = 0.02;
  surface.material.damping = 0.02;
  return surface;
}

Force push_at(const Value<3>& center, double magnitude, double radius) {
  Force force = poke("p", center, magnitude);
  force.deformation_radius = radius;
  force.force_radius = 0.7 * radius;
  force.falloff = Falloff::Smooth;
  return force;
}

// The text of an .obj with all digits.
std::string obj_of(const Mesh& mesh) {
  std::string text;
  for (Eigen::Index k = 0; k < mesh.positions.rows(); ++k)
    text += fmt::format("v {} {} {}\n", mesh.positions(k, 0), mesh.positions(k, 1),
                        mesh.positions(k, 2));
  for (const auto& [u, v] : mesh.uvs) text += fmt::format("vt {} {}\n", u, v);
  std::size_t corner = 0;
  for (const int size : mesh.face_sizes) {
    text += "f";
    for (int k = 0; k < size; ++k, ++corner)
      text += fmt::format(" {}/{}", mesh.corner_vertices[corner] + 1, mesh.corner_uvs[corner] + 1);
    text += "\n";
  }
  return text;
}

std::vector<std::string> problems_of(const Surface& surface) {
  std::vector<std::string> problems;
  for (const Error& error : check_scene(scene({surface}, {}))) problems.push_back(error.message);
  return problems;
}

}  // namespace

TEST_CASE("a sheet read as a surface is the mesh of its vertices and faces, to the bit",
          "[simulation][sheet_surface]") {
  const ScratchFolder folder;
  for (const bool triangles : {false, true}) {
    const GridSheet sheet{
        .columns = 14, .rows = 11, .width = 3, .depth = 2, .triangles = triangles};
    Surface own = round_sheet(sheet);
    own.material.d = 1.3;
    own.material.yield = 8.0;
    own.tangents.su1 = TangentChannel(Channel<1>(0.2));
    Surface mesh = own;
    folder.write("sheet.obj", obj_of(make_mesh(sheet)));
    mesh.shape = MeshFile{folder.file("sheet.obj").string()};
    mesh.reading.unit = std::array{3.0, 2.0};
    const std::vector<Force> forces = {push_at({0.4, 0, -0.2}, 3000, 0.9)};
    const auto expected = baked(scene({mesh}, forces), "s");
    REQUIRE(peak(expected) > 0.05);
    CHECK(baked(scene({own}, forces), "s") == expected);

    // What a sheet says itself is what the mesh would say.
    for (const Border border : {Border::Clamped, Border::Pinned, Border::Free}) {
      own.reading.border = border;
      own.reading.unit = std::array{2.5, 1.5};
      own.reading.axis = std::array{1.0, 0.0, 2.0};
      mesh.reading = own.reading;
      CHECK(baked(scene({own}, forces), "s") == baked(scene({mesh}, forces), "s"));
    }
  }
}

TEST_CASE("a dent in a sheet read as a surface is round", "[simulation][sheet_surface]") {
  constexpr int count = 41;
  Surface surface = round_sheet({.columns = count, .rows = count, .width = 4, .depth = 4});
  surface.solver.integrator = Integrator::Newmark;
  const double radius = 1.35;
  const Scene round = scene({surface}, {push_at({0, 0, 0}, 3000, radius)}, 6);
  const auto frames = baked(round, "s");
  REQUIRE(peak(frames) > 0.05);
  const Field& rest = frames.front();
  const Field moved = frames.back() - rest;
  int inside = 0, in_corners = 0;
  for (int j = 0; j < count; ++j) {
    for (int i = 0; i < count; ++i) {
      const int node = j * count + i, turned = i * count + j;
      // The factor's order has no such symmetry, so that it is one but for rounding.
      REQUIRE(std::abs(moved(node, 1) - moved(turned, 1)) < 1e-9 * peak(frames));
      const double distance = rest.row(node).norm();
      if (distance >= radius) CHECK(moved.row(node).isZero(0));
      if (distance < 0.95 * radius) {
        CHECK(moved(node, 1) != 0);
        ++inside;
      }
      const double along = std::max(std::abs(rest(node, 0)), std::abs(rest(node, 2)));
      if (along < 0.9 * radius && distance >= radius) ++in_corners;
    }
  }
  CHECK(inside > 400);
  REQUIRE(in_corners > 50);
  // The grid of the same sheet moves the corners of the box around the sphere too.
  surface.reading = {};
  const auto boxed = baked(scene({surface}, round.forces, 6), "s");
  int moved_corners = 0;
  for (int node = 0; node < count * count; ++node)
    moved_corners += rest.row(node).norm() >= radius && boxed.back()(node, 1) != 0;
  CHECK(moved_corners >= in_corners);
}

TEST_CASE("numbers carry over from a sheet's grid to its surface", "[simulation][sheet_surface]") {
  // Static and clamped, with another unit along u than along v and a stiffness that differs too.
  const auto peak_of = [](int cells, bool is_surface) {
    Surface surface =
        round_sheet({.columns = cells + 1, .rows = cells + 1, .width = 3, .depth = 2});
    if (!is_surface) surface.reading = {};
    surface.material.density = 0.0;
    surface.material.damping = 0.0;
    surface.material.d = 1.7;
    surface.solver.region = SolvedRegion::All;
    surface.solver.measure = Measure::Rest;
    Force force = push_at({0, 0, 0}, 1000, 1);
    force.force_radius = 0.8;
    auto simulation = Simulation::make(scene({surface}, {force}, 2)).value();
    const Field positions = simulation.at(2).value().surface("s").positions();
    return positions.col(1).maxCoeff();
  };
  const double expected = peak_of(256, false);
  REQUIRE(expected > 0.05);
  double before = 0;
  for (const int cells : {16, 32, 64}) {
    const double apart = std::abs(peak_of(cells, true) / expected - 1);
    CAPTURE(cells, apart, before);
    if (before > 0) CHECK(apart < 0.35 * before);  // order h^2, less what the grid's is off
    before = apart;
  }
  CHECK(before < 2e-3);
}

TEST_CASE("a map of rows x columns is one of a sheet read as a surface",
          "[simulation][sheet_surface]") {
  const ScratchFolder folder;
  Surface surface = round_sheet({.columns = 9, .rows = 7, .width = 4, .depth = 3});
  std::vector<double> values;
  for (int k = 0; k < 9 * 7; ++k) values.push_back(0.1 + 0.011 * k);
  const std::string literal = "{'descr': '<f8', 'fortran_order': False, 'shape': (7, 9), }\n";
  std::string npy = "\x93NUMPY";
  npy += {'\1', '\0', static_cast<char>(literal.size()), '\0'};
  npy += literal;
  for (const double value : values) npy.append(reinterpret_cast<const char*>(&value), 8);
  folder.write("m.npy", npy);
  surface.maps = {
      {.channel = MapChannel::B, .file = folder.file("m.npy").string(), .low = 0.5, .high = 2}};
  const std::vector<Force> forces = {push_at({0.4, 0, -0.2}, 3000, 1.4)};
  const auto by_file = baked(scene({surface}, forces), "s");
  REQUIRE(peak(by_file) > 0.05);
  surface.maps = {{.channel = MapChannel::B, .low = 0.5, .high = 2, .values = values}};
  CHECK(baked(scene({surface}, forces), "s") == by_file);
}

TEST_CASE("a cache carries a sheet read as a surface", "[simulation][sheet_surface]") {
  const ScratchFolder folder;
  const GridSheet sheet{.columns = 15, .rows = 15, .width = 4, .depth = 4};
  const Surface still = round_sheet(sheet);
  const Force force = push_at({0.4, 0, -0.2}, 3000, 1.4);
  const auto expected = baked(scene({still}, {force}), "s");
  // It rises and the force with it, so that all moves as without, but higher.
  std::vector<Field> samples;
  std::vector<std::pair<double, Value<3>>> centers;
  for (int frame = 1; frame <= 12; ++frame) {
    samples.push_back(expected.front());
    samples.back().col(1).array() += 0.25 * frame;
    centers.push_back({double(frame), {0.4, 0.25 * frame, -0.2}});
  }
  Surface rising = still;
  rising.cache.path = write_cache(folder, "rise.pc2", samples);
  Force follows = force;
  follows.kind = PointChannels{.center = vector_curve(centers)};
  const auto carried = baked(scene({rising}, {follows}), "s");
  for (std::size_t k = 0; k < carried.size(); ++k) {
    Field lowered = carried[k];
    lowered.col(1).array() -= 0.25 * (static_cast<double>(k) + 1);
    CHECK(largest_difference(lowered, expected[k]) < 1e-5 * peak(expected));  // float32 samples
  }
}

TEST_CASE("a sheet read as a surface drives others", "[simulation][sheet_surface]") {
  const Surface sheet = round_sheet({.columns = 21, .rows = 21, .width = 4, .depth = 4});
  Surface skin = round_sheet({.columns = 21, .rows = 21, .width = 4, .depth = 4});
  skin.name = "skin";
  skin.driven_by = "s";
  const Scene both = scene({sheet, skin}, {push_at({0.4, 0, -0.2}, 3000, 1.4)});
  const auto frames = baked(both, "s"), driven = baked(both, "skin");
  REQUIRE(peak(frames) > 0.05);
  for (std::size_t k = 0; k < frames.size(); ++k)
    CHECK(largest_difference(frames[k], driven[k]) < 1e-12);
}

TEST_CASE("what only a surface has needs uv=\"surface\" on a sheet",
          "[simulation][sheet_surface]") {
  const auto complaint = [](const std::string& grid, const std::string& solver = "") {
    const auto read =
        parse_scene(fmt::format("<scene version='1' start='1' end='2'><surface name='s'>"
                                "<grid columns='5' rows='5' {}/>{}</surface></scene>",
                                grid, solver),
                    "a.xml", ".");
    return read ? std::string() : read.error().message;
  };
  const std::string unit = "unit='2 1'", border = "border='free'", axis = "axis='1 0 1'";
  CHECK(complaint("uv='surface' " + unit + " " + border + " " + axis) == "");
  CHECK(complaint("uv='grid'") == "");
  CHECK(complaint("uv='auto'") == "");
  for (const std::string& given : {unit, border, axis}) {
    const std::string name = given.substr(0, given.find('='));
    for (const std::string uv : {"", "uv='grid' ", "uv='auto' "})
      CHECK_THAT(complaint(uv + given), Contains("s." + name) && Contains("uv=\"surface\""));
  }
  const std::string edges = "<solver region='all' edges='pinned'/>";
  CHECK(complaint("", edges) == "");
  CHECK_THAT(complaint("uv='surface'", edges), Contains("s.edges") && Contains("border"));
  CHECK_THAT(complaint("uv='surface'", "<solver edges='clamped'/>"),
             Contains("s.edges") && Contains("border"));

  Surface surface = round_sheet({.columns = 5, .rows = 5});
  CHECK(problems_of(surface).empty());
  surface.reading.weld = 0.1;
  REQUIRE(problems_of(surface).size() == 1);
  CHECK_THAT(problems_of(surface)[0], Contains("s.weld is for a mesh"));
  surface.reading = {.wrap = Wrap::U};
  REQUIRE(problems_of(surface).size() == 1);
  CHECK_THAT(problems_of(surface)[0], Contains("s.wrap is for a mesh"));
  surface = round_sheet({.columns = 5, .rows = 5});
  surface.solver.reference = Reference::None;
  CHECK_THAT(Simulation::make(scene({surface}, {})).error().message,
             Contains("needs a grid") && Contains("the sheet is read as a surface"));
}

TEST_CASE("a sheet read as a surface is written as it was read", "[simulation][sheet_surface]") {
  Surface surface = round_sheet({.columns = 5, .rows = 7, .width = 2, .depth = 3});
  for (const bool gives_all : {false, true}) {
    if (gives_all) {
      surface.reading.unit = std::array{2.0, 1.5};
      surface.reading.axis = std::array{0.0, 0.0, 1.0};
      surface.reading.border = Border::Pinned;
    }
    const Scene own = scene({surface}, {});
    const auto text = to_xml(own);
    REQUIRE(text);
    CHECK_THAT(*text, Contains("uv=\"surface\""));
    CHECK(parse_scene(*text, "a.xml", ".").value() == own);
  }
}
