#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "pliant/files/formats.hpp"
#include "pliant/scene/read.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/png.hpp"
#include "support/sanitized.hpp"
#include "support/scenes.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

// Maps of the material, over whole runs.

namespace {

constexpr MapChannel all_channels[] = {MapChannel::Density, MapChannel::Damping, MapChannel::B,
                                       MapChannel::C, MapChannel::D};

Channel<1>& channel_of(MaterialChannels& material, MapChannel channel) {
  Channel<1>* const channels[] = {&material.density, &material.damping, &material.b, &material.c,
                                  &material.d};
  return *channels[static_cast<std::size_t>(channel)];
}

// A mesh of triangles, or of quads that are divided round their centres, with (u,v).
Surface mixed_mesh(bool has_quads = false) {
  Surface surface;
  surface.name = "s";
  Mesh mesh = square(12, 6, 0.3, has_quads);
  for (Eigen::Index k = 0; k < mesh.positions.rows(); ++k)
    mesh.uvs.push_back({mesh.positions(k, 0), mesh.positions(k, 2)});
  mesh.corner_uvs = mesh.corner_vertices;
  surface.shape = std::move(mesh);
  surface.reading.uv = UvReading::Surface;
  surface.material.density = 0.02;
  surface.material.damping = 0.02;
  surface.material.poisson = 0.0;
  return surface;
}

// A map of a program: m at each vertex by its place at rest.
MaterialMap map_of(const Surface& surface, MapChannel channel,
                   const std::function<double(double x, double z)>& m, double low = 0,
                   double high = 1) {
  MaterialMap map{.channel = channel, .low = low, .high = high};
  const auto* const sheet = std::get_if<GridSheet>(&surface.shape);
  const Mesh mesh = sheet ? make_mesh(*sheet) : std::get<Mesh>(surface.shape);
  for (Eigen::Index k = 0; k < mesh.positions.rows(); ++k)
    map.values.push_back(m(mesh.positions(k, 0), mesh.positions(k, 2)));
  return map;
}

MaterialMap even_map(const Surface& surface, MapChannel channel, double factor) {
  return map_of(surface, channel, [=](double, double) { return factor; });
}

Force press(double magnitude, double radius = 4.5) {
  Force force = poke("p", {0.4, 0, -0.3}, magnitude);
  force.deformation_radius = radius;
  force.force_radius = 0.6 * radius;
  return force;
}

struct MappedCase {
  std::string name;
  Surface surface;
  Force force;
};
std::vector<MappedCase> mapped_cases() {
  return {{"grid", sheet("s"), press(5000)},
          {"triangles", mixed_mesh(), press(300, 2.2)},
          {"quads", mixed_mesh(true), press(300, 2.2)}};
}

std::string problem_of(const Scene& scene) {
  const auto simulation = Simulation::make(scene);
  const auto checked = Simulation::check(scene);
  CHECK(simulation.has_value() == checked.has_value());
  if (simulation) return "none";
  const std::vector<std::string> lines = to_lines(simulation.error());
  CHECK(lines == to_lines(checked.error()));
  std::string all;
  for (const std::string& line : lines) all += line + '\n';
  return all;
}

}  // namespace

TEST_CASE("a uniform map is the scaled channel", "[simulation][maps]") {
  for (auto& [name, surface, force] : mapped_cases()) {
    for (const MapChannel channel : all_channels) {
      for (const bool is_newmark : {false, true}) {
        if (is_sanitized && is_newmark != (channel == MapChannel::C)) continue;
        CAPTURE(name, static_cast<int>(channel), is_newmark);
        Surface scaled = surface;
        if (is_newmark) scaled.solver.integrator = Integrator::Newmark;
        Surface mapped = scaled;
        const double factor = 1.7;
        Channel<1>& number = channel_of(scaled.material, channel);
        number = number.at(1)[0] * factor;
        // Poisson's ratio acts on a grid with a map only.
        if (name == "grid") scaled.material.poisson = mapped.material.poisson = 0.0;
        mapped.maps = {even_map(mapped, channel, factor)};
        const auto expected = baked(scene({scaled}, {force}), "s");
        const auto got = baked(scene({mapped}, {force}), "s");
        REQUIRE(peak(expected) > 0.05);
        for (std::size_t frame = 0; frame < got.size(); ++frame)
          CHECK(largest_difference(got[frame], expected[frame]) < 1e-11 * peak(expected));
      }
    }
  }
}

TEST_CASE("by a damping ratio each node is damped by its own density", "[simulation][maps]") {
  for (auto& [name, surface, force] : mapped_cases()) {
    CAPTURE(name);
    surface.material.damping = MaterialChannels().damping;
    surface.material.damping_ratio = 0.2;
    Surface scaled = surface, mapped = surface;
    mapped.maps = {even_map(mapped, MapChannel::Density, 1.7)};
    scaled.material.density = 1.7 * scaled.material.density.at(1)[0];
    const auto expected = baked(scene({scaled}, {force}), "s");
    const auto got = baked(scene({mapped}, {force}), "s");
    CHECK(largest_difference(got.back(), expected.back()) < 1e-8 * peak(expected));
  }
}

TEST_CASE("a map of 1 everywhere changes nothing but rounding", "[simulation][maps]") {
  for (auto& [name, surface, force] : mapped_cases()) {
    for (const Border border : {Border::Clamped, Border::Pinned, Border::Free}) {
      if (name == "grid" && border != Border::Clamped) continue;
      CAPTURE(name, static_cast<int>(border));
      if (name != "grid") surface.reading.border = border;
      surface.solver.region = SolvedRegion::All;
      surface.maps.clear();
      const auto plain = baked(scene({surface}, {force}), "s");
      for (const MapChannel channel : all_channels)
        surface.maps.push_back(even_map(surface, channel, 1));
      const auto mapped = baked(scene({surface}, {force}), "s");
      CHECK(largest_difference(mapped.back(), plain.back()) < 1e-11 * peak(plain));
    }
  }
}

TEST_CASE("a keyed channel is multiplied by its map at each frame", "[simulation][maps]") {
  for (auto& [name, surface, force] : mapped_cases()) {
    CAPTURE(name);
    Surface scaled = surface, mapped = surface;
    mapped.material.b = curve({{1, 1}, {12, 3}});
    scaled.material.b = curve({{1, 0.5}, {12, 1.5}});
    mapped.maps = {even_map(mapped, MapChannel::B, 0.5)};
    const auto expected = baked(scene({scaled}, {force}), "s");
    const auto got = baked(scene({mapped}, {force}), "s");
    CHECK(largest_difference(got.back(), expected.back()) < 1e-11 * peak(expected));
  }
}

TEST_CASE("the soft half of a sheet gives more", "[simulation][maps]") {
  for (auto& [name, surface, force] : mapped_cases()) {
    CAPTURE(name);
    const auto is_soft = [](double x, double) { return x < 0 ? 0.0 : 1.0; };
    surface.solver.region = SolvedRegion::All;
    force.kind = UniformChannels{};
    force.magnitude = name == "grid" ? 10.0 : 20.0;
    force.deformation_radius = force.force_radius = 1e3;
    for (const MapChannel channel : {MapChannel::B, MapChannel::C, MapChannel::D})
      surface.maps.push_back(map_of(surface, channel, is_soft, 0.1, 1));
    const auto frames = baked(scene({surface}, {force}, 30), "s");
    double left = 0, right = 0;
    for (Eigen::Index k = 0; k < frames[0].rows(); ++k) {
      const double way = frames.back()(k, 1) - frames[0](k, 1);
      const double x = frames[0](k, 0) / frames[0].col(0).maxCoeff();
      if (x < -0.33) left = std::max(left, way);
      if (x > 0.33) right = std::max(right, way);
    }
    CHECK(right > 0);
    CHECK(left > 2 * right);
  }
}

TEST_CASE("a mirrored map mirrors the motion", "[simulation][maps]") {
  Surface surface = sheet("s");
  surface.solver.region = SolvedRegion::All;
  Force force = press(20);
  force.kind = UniformChannels{};
  force.force_radius = 1e3;
  const auto m = [](double x, double z) { return 0.3 + 0.02 * (x + 6) * (z + 7); };
  Surface mirrored = surface;
  for (const MapChannel channel : all_channels) {
    surface.maps.push_back(map_of(surface, channel, m));
    mirrored.maps.push_back(
        map_of(mirrored, channel, [&](double x, double z) { return m(-x, z); }));
  }
  const auto one = baked(scene({surface}, {force}), "s");
  const auto other = baked(scene({mirrored}, {force}), "s");
  REQUIRE(peak(one) > 0.01);
  for (int j = 0; j < 13; ++j) {
    for (int i = 0; i < 13; ++i) {
      const auto way = one.back().row(13 * j + i) - one[0].row(13 * j + i);
      const auto back = other.back().row(13 * j + 12 - i) - other[0].row(13 * j + 12 - i);
      CHECK((way - back).norm() < 1e-11 * peak(one));
    }
  }
}

TEST_CASE("regions and islands take the part of a map that they cover", "[simulation][maps]") {
  // Where the map is 1, the pokes of an uneven sheet act as those of an even one.
  for (const Combine combine : {Combine::Box, Combine::Islands}) {
    Surface surface = sheet("s", 25);
    surface.solver.combine = combine;
    Force left = poke("l", {-7, 0, 0}), right = poke("r", {7, 0, 0});
    left.deformation_radius = right.deformation_radius = 3.5;
    const auto m = [](double x, double) { return x < 0 ? 1.0 : 0.25; };
    Surface mapped = surface;
    mapped.material.poisson = 0.0;
    for (const MapChannel channel : {MapChannel::B, MapChannel::C, MapChannel::D})
      mapped.maps.push_back(map_of(mapped, channel, m));
    const auto plain = baked(scene({surface}, {left, right}), "s");
    const auto got = baked(scene({mapped}, {left, right}), "s");
    if (combine == Combine::Islands) {
      const auto softer = [&](Field frame) {
        return (frame - plain[0]).rowwise().norm().maxCoeff();
      };
      Surface soft = surface;
      soft.material.b = soft.material.d = 0.25;
      soft.material.c = 0.5;
      const auto all_soft = baked(scene({soft}, {left, right}), "s");
      for (Eigen::Index k = 0; k < plain[0].rows(); ++k) {
        const Field& expected = (plain[0](k, 0) < 0 ? plain : all_soft).back();
        CHECK((got.back().row(k) - expected.row(k)).norm() < 1e-11 * softer(all_soft.back()));
      }
    } else {
      CHECK(peak(got) > 1.2 * peak(plain));
    }
  }
}

TEST_CASE("a map of density on a union moves it as its scaled density", "[simulation][maps]") {
  Surface surface = sheet("s", 17);
  surface.solver.combine = Combine::Union;
  const Force one = press(5000, 3.5);
  Force other = press(5000, 3.5);
  other.name = "q";
  other.kind = PointChannels{.center = Value<3>{4, 0, 3}};
  Surface mapped = surface;
  mapped.maps = {even_map(mapped, MapChannel::Density, 3),
                 even_map(mapped, MapChannel::Damping, 0.5)};
  surface.material.density = 120.0;
  surface.material.damping = 10.0;
  const auto expected = baked(scene({surface}, {one, other}), "s");
  const auto got = baked(scene({mapped}, {one, other}), "s");
  CHECK(largest_difference(got.back(), expected.back()) < 1e-10 * peak(expected));
}

TEST_CASE("inertia pulls each node by its own density", "[simulation][maps]") {
  for (auto& [name, surface, force] : mapped_cases()) {
    CAPTURE(name);
    surface.solver.region = SolvedRegion::All;
    surface.transform.translate = vector_curve({{1, {0, 0, 0}}, {4, {0, 3, 0}}, {9, {0, -2, 0}}});
    Force inertia;
    inertia.name = "i";
    inertia.kind = InertiaChannels{};
    inertia.magnitude = 1;
    inertia.force_radius = 1;
    const auto object_space = [&](const Surface& one) {
      auto simulation = Simulation::make(scene({one}, {inertia})).value();
      return simulation.at(9)->surface("s").object_positions();
    };
    const auto m = [](double x, double) { return x < 0 ? 0.0 : 1.0; };
    // Half of it has no density: it is pulled by nothing but its other half.
    Surface half = surface;
    half.maps = {map_of(half, MapChannel::Density, m)};
    // A uniform map is the scaled density.
    Surface scaled = surface, even = surface;
    even.maps = {even_map(even, MapChannel::Density, 2)};
    scaled.material.density = 2 * scaled.material.density.at(1)[0];
    Surface still = surface;
    still.transform = {};
    const Field rest = object_space(still);
    const Field heavy = object_space(scaled);
    const double size = largest_difference(heavy, rest);
    REQUIRE(size > 1e-3);
    CHECK(largest_difference(object_space(even), heavy) < 1e-11 * size);
    const Field uneven = object_space(half);
    double left = 0, right = 0;
    for (Eigen::Index k = 0; k < rest.rows(); ++k) {
      double& side = rest(k, 0) < 0 ? left : right;
      side = std::max(side, (uneven - rest).row(k).norm());
    }
    CHECK(right > 1.1 * left);
  }
}

TEST_CASE("a map that makes the density 0 everywhere leaves no inertia", "[simulation][maps]") {
  for (auto& [name, surface, force] : mapped_cases()) {
    CAPTURE(name);
    surface.solver.integrator = Integrator::Newmark;
    Surface light = surface;
    light.maps = {even_map(light, MapChannel::Density, 0)};
    surface.material.density = 0.0;
    const auto expected = baked(scene({surface}, {force}), "s");
    CHECK(largest_difference(baked(scene({light}, {force}), "s").back(), expected.back()) <
          1e-11 * peak(expected));
  }
}

TEST_CASE("runs with maps repeat to the bit, in any order and with any threads",
          "[simulation][maps][threads]") {
  for (auto& [name, surface, force] : mapped_cases()) {
    CAPTURE(name);
    const auto m = [](double x, double z) { return 1 + 0.4 * std::sin(3 * x + z); };
    for (const MapChannel channel : all_channels)
      surface.maps.push_back(map_of(surface, channel, m));
    const Scene whole = scene({surface}, {force});
    const auto frames = baked(whole, "s");
    REQUIRE(peak(frames) > 0.05);
    CHECK(baked(whole, "s") == frames);
    auto threaded = Simulation::make(whole, {.threads = 3}).value();
    for (const int frame : {12, 3, 7, 1, 12}) {
      CHECK(threaded.at(frame)->surface("s").positions() ==
            frames[static_cast<std::size_t>(frame - 1)]);
    }
    auto saved = Simulation::make(whole).value();
    const std::string bytes = saved.state_bytes(6).value();
    auto restored = Simulation::make(whole).value();
    REQUIRE(restored.restore(bytes));
    CHECK(restored.at(12)->surface("s").positions() == frames.back());
  }
}

TEST_CASE("a state of another map is not taken", "[simulation][maps]") {
  Surface surface = sheet("s");
  surface.maps = {map_of(surface, MapChannel::B, [](double x, double) { return 1 + 0.01 * x; })};
  auto one = Simulation::make(scene({surface}, {press(5000)})).value();
  const std::string bytes = one.state_bytes(6).value();
  surface.maps[0].values[80] += 1e-15;
  auto other = Simulation::make(scene({surface}, {press(5000)})).value();
  CHECK_FALSE(other.restore(bytes));
}

TEST_CASE("pictures, numbers and attributes of one map move a body alike", "[simulation][maps]") {
  const ScratchFolder folder;
  // 5 x 5 nodes at the centres of 5 x 5 pixels would need (u,v) of 0.1 to 0.9: the mesh has them.
  GridSheet sheet{.columns = 5, .rows = 5, .width = 4, .depth = 4};
  Mesh mesh = make_mesh(sheet);
  for (auto& [u, v] : mesh.uvs) u = 0.1 + 0.8 * u, v = 0.1 + 0.8 * v;
  std::vector<int> pixels;
  std::vector<double> values;
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 5; ++i) values.push_back((50 + 7 * i + 31 * j) / 255.0);
  for (int j = 4; j >= 0; --j)  // a picture begins at the top
    for (int i = 0; i < 5; ++i) pixels.push_back(50 + 7 * i + 31 * j);
  folder.write("m.png", grey_png(5, 5, pixels));
  std::string literal = "{'descr': '<f8', 'fortran_order': False, 'shape': (5, 5), }\n";
  std::string npy = "\x93NUMPY";
  npy += {'\1', '\0', static_cast<char>(literal.size()), '\0'};
  npy += literal;
  for (const double value : values) npy.append(reinterpret_cast<const char*>(&value), 8);
  folder.write("m.npy", npy);
  std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 25\nproperty double x\nproperty double y\n"
      "property double z\nproperty double s\nproperty double t\nproperty double soft\n"
      "element face 16\nproperty list uchar int vertex_indices\nend_header\n";
  for (int k = 0; k < 25; ++k)
    ply += fmt::format("{} {} {} {} {} {}\n", mesh.positions(k, 0), mesh.positions(k, 1),
                       mesh.positions(k, 2), mesh.uvs[k][0], mesh.uvs[k][1], values[k]);
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i)
      ply += fmt::format("4 {} {} {} {}\n", 5 * j + i, 5 * (j + 1) + i, 5 * (j + 1) + i + 1,
                         5 * j + i + 1);
  folder.write("m.ply", ply);

  Surface surface;
  surface.name = "s";
  surface.shape = MeshFile{.path = folder.file("m.ply").string()};
  surface.material.density = 40.0;
  Force force = press(30, 1.9);
  const auto play = [&](MaterialMap map) {
    surface.maps = {};
    for (const MapChannel channel : all_channels) {
      map.channel = channel;
      surface.maps.push_back(map);
    }
    return baked(scene({surface}, {force}), "s");
  };
  for (const UvReading uv : {UvReading::Grid, UvReading::Surface}) {
    CAPTURE(static_cast<int>(uv));
    surface.reading.uv = uv;
    const auto by_attribute = play({.attribute = "soft", .low = 0.5, .high = 2});
    REQUIRE(peak(by_attribute) > 0.01);
    const auto by_program = play({.low = 0.5, .high = 2, .values = values});
    CHECK(by_program == by_attribute);
    const auto by_picture = play({.file = folder.file("m.png").string(), .low = 0.5, .high = 2});
    CHECK(largest_difference(by_picture.back(), by_attribute.back()) < 1e-12 * peak(by_attribute));
    if (uv != UvReading::Grid) continue;
    CHECK(play({.file = folder.file("m.npy").string(), .low = 0.5, .high = 2}) == by_attribute);
  }
  // A mesh of a program has attributes too.
  mesh.attributes = {{"soft", values}};
  const auto expected = play({.attribute = "soft"});
  surface.shape = mesh;
  CHECK(largest_difference(play({.attribute = "soft"}).back(), expected.back()) <
        1e-12 * peak(expected));
  surface.maps = {{.channel = MapChannel::B, .attribute = "hard"}};
  CHECK_THAT(problem_of(scene({surface}, {force})),
             Contains("s.map.b: the mesh has no attribute hard"));
}

TEST_CASE("a picture lies on a sheet with v upwards, and is held at its border",
          "[simulation][maps]") {
  const ScratchFolder folder;
  // The upper left pixel alone is white: u small, v large, which is x small, z large.
  folder.write("m.png", grey_png(2, 2, {255, 0, 0, 0}));
  Surface surface = sheet("s");
  surface.maps = {{.channel = MapChannel::Density, .file = folder.file("m.png").string()}};
  auto simulation = Simulation::make(scene({surface}, {press(5000)})).value();
  surface.maps = {map_of(surface, MapChannel::Density, [](double x, double z) {
    const auto share = [](double t) { return std::clamp(2 * t - 0.5, 0.0, 1.0); };
    return (1 - share((x + 6) / 12)) * share((z + 6) / 12);
  })};
  auto expected = Simulation::make(scene({surface}, {press(5000)})).value();
  CHECK(largest_difference(simulation.at(12)->surface("s").positions(),
                           expected.at(12)->surface("s").positions()) < 1e-12);
}

TEST_CASE("a map lies on the control points of a net", "[simulation][maps]") {
  const ScratchFolder folder;
  std::vector<int> pixels;
  for (int k = 0; k < 64; ++k) pixels.push_back(100 + 2 * k);
  folder.write("m.png", grey_png(8, 8, pixels));
  NurbsNet net;
  net.u = {.count = 7, .degree = 2};
  net.v = {.count = 6, .degree = 2};
  net.points.resize(42, 3);
  for (int j = 0; j < 6; ++j)
    for (int i = 0; i < 7; ++i) net.points.row(7 * j + i) << i - 3.0, 0, j - 2.5;
  Surface surface;
  surface.name = "s";
  surface.shape = net;
  surface.material.density = 40.0;
  const auto play = [&](MaterialMap map) {
    surface.maps = {std::move(map)};
    return baked(scene({surface}, {press(50, 2.2)}), "s");
  };
  MaterialMap by_hand{.channel = MapChannel::B};
  for (int j = 0; j < 6; ++j) {
    for (int i = 0; i < 7; ++i) {
      const double x = std::clamp(8 * (i / 6.0) - 0.5, 0.0, 7.0);
      const double y = std::clamp(8 * (1 - j / 5.0) - 0.5, 0.0, 7.0);
      by_hand.values.push_back((100 + 2 * (x + 8 * y)) / 255);
    }
  }
  const auto expected = play(by_hand);
  REQUIRE(peak(expected) > 0.01);
  const auto got = play({.channel = MapChannel::B, .file = folder.file("m.png").string()});
  CHECK(largest_difference(got.back(), expected.back()) < 1e-12 * peak(expected));
  by_hand.values.pop_back();
  surface.maps = {by_hand};
  CHECK_THAT(problem_of(scene({surface}, {})),
             Contains("the map has 41 values, but the surface has 42 control points"));
}

TEST_CASE("what a map makes of the material is checked at every node and frame",
          "[simulation][maps]") {
  Surface surface = sheet("s");
  const Scene plain = scene({surface}, {press(5000)});
  const auto at_one_node = [&](MapChannel channel, double value) {
    MaterialMap map = even_map(surface, channel, 1);
    map.values[13 * 4 + 7] = value;
    return map;
  };
  const auto problem = [&](std::vector<MaterialMap> maps,
                           const std::function<void(Surface&)>& change = {}) {
    Scene changed = plain;
    changed.surfaces[0].maps = std::move(maps);
    if (change) change(changed.surfaces[0]);
    return problem_of(changed);
  };
  CHECK(problem({at_one_node(MapChannel::B, 0.1)}) == "none");
  CHECK_THAT(problem({at_one_node(MapChannel::B, 0)}),
             Contains("s.b is 0 at node (7, 4) by its map, but must be greater than 0"));
  CHECK_THAT(problem({at_one_node(MapChannel::D, -1)}),
             Contains("s.d is -1 at node (7, 4) by its map, but must be greater than 0"));
  CHECK_THAT(problem({at_one_node(MapChannel::Density, -0.5)}),
             Contains("s.density is -20 at node (7, 4) by its map, but must be at least 0"));
  CHECK_THAT(problem({at_one_node(MapChannel::Damping, -1e-300)}),
             Contains("s.damping is -2e-299"));
  CHECK(problem({at_one_node(MapChannel::Density, 0)}) == "none");
  CHECK_THAT(problem({at_one_node(MapChannel::B, 1e308)}, [](Surface& s) { s.material.b = 100.0; }),
             Contains("s.b is inf at node (7, 4) by its map, but must be finite"));
  // c between -2 sqrt(b d) and 2 poisson sqrt(b d).
  CHECK_THAT(
      problem({at_one_node(MapChannel::C, -1)}),
      Contains("s.c is -2 at node (7, 4), where b = 1 and d = 1, but must be greater than -2 "
               "sqrt(b d) = -2"));
  CHECK_THAT(problem({at_one_node(MapChannel::C, 0.25)}),
             Contains("s.poisson is 0.3, but with a map of b, c or d it must be between -1 and 1, "
                      "and c = 0.5 at node (7, 4), where b = 1 and d = 1 must be greater than 2 "
                      "poisson sqrt(b d) = 0.6; a smaller poisson helps"));
  CHECK(problem({at_one_node(MapChannel::C, 0.25)}, [](Surface& s) { s.material.poisson = 0.2; }) ==
        "none");
  CHECK_THAT(problem({at_one_node(MapChannel::B, 25)}), Contains("poisson sqrt(b d) = 3"));
  CHECK_THAT(problem({at_one_node(MapChannel::C, 1)}, [](Surface& s) { s.material.poisson = 1.0; }),
             Contains("s.poisson is 1,"));
  // Without a map of stiffness poisson has no effect and no range.
  CHECK(problem({at_one_node(MapChannel::Density, 2)},
                [](Surface& s) { s.material.poisson = 7.0; }) == "none");
  // A keyed channel that only some frame spoils.
  CHECK_THAT(problem({at_one_node(MapChannel::C, 0.5)},
                     [](Surface& s) {
                       s.material.c = curve({{1, 2}, {5, 2}, {6, 1}, {12, 1}});
                     }),
             Contains("s.poisson at frame 6 is 0.3"));
  CHECK_THAT(
      problem({at_one_node(MapChannel::Density, 0)},
              [](Surface& s) { s.solver.integrator = Integrator::Newmark; }),
      Contains("s.density is 0 at node (7, 4) by its map, but integrator=\"newmark\" needs a "
               "density at all nodes or at none"));
  // One error a channel, all in one run.
  auto several = Simulation::check([&] {
    Scene changed = plain;
    changed.surfaces[0].maps = {at_one_node(MapChannel::B, -1), at_one_node(MapChannel::D, 0),
                                at_one_node(MapChannel::Damping, -1)};
    return changed;
  }());
  REQUIRE_FALSE(several);
  CHECK(to_lines(several.error()).size() >= 2);
}

TEST_CASE("on triangles the material is checked at triangles too", "[simulation][maps]") {
  Surface surface = mixed_mesh();
  surface.material.poisson = 0.3;
  MaterialMap b = even_map(surface, MapChannel::B, 1), c = even_map(surface, MapChannel::C, 1);
  // c / sqrt(b d) is 2 or 0.604 at nodes, but a triangle has means: 0.582 with two of the latter.
  for (std::size_t k = 0; k < b.values.size(); k += 2) {
    b.values[k] = 81;
    c.values[k] = 2.72;
  }
  surface.maps = {b, c};
  CHECK_THAT(problem_of(scene({surface}, {})),
             Contains("s.poisson is 0.3") && Contains("triangle"));
  surface.maps = {even_map(surface, MapChannel::B, 1)};
  surface.maps[0].values[3] = 0;
  CHECK_THAT(problem_of(scene({surface}, {})),
             Contains("s.b is 0 at node 3 by its map, but must be greater than 0"));
}

TEST_CASE("a map that cannot be read names its line, its file and the reason",
          "[simulation][maps]") {
  const ScratchFolder folder;
  folder.write("m.obj", "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3 4\n");
  folder.write("bad.png", "rubbish");
  folder.write("good.png", grey_png(1, 1, {255}));
  folder.write("text.npy", "rubbish");
  const auto problem = [&](const std::string& shape, const std::string& map) {
    const auto text = "<scene version=\"1\" start=\"1\" end=\"2\">\n<surface name=\"s\">\n" +
                      shape + "\n<material>\n<map channel=\"b\" " + map +
                      "/>\n</material>\n</surface>\n</scene>";
    const auto loaded = load_scene(folder.write("a.xml", text).string());
    REQUIRE(loaded);
    const auto checked = Simulation::check(*loaded);
    if (checked) return std::string("none");
    CHECK(to_lines(checked.error()).size() == 1);
    return to_lines(checked.error()).front();
  };
  const std::string sheet = R"(<grid columns="5" rows="4"/>)";
  const std::string file = folder.file("a.xml").string() + ":5: error: s.map.b: ";
  const auto path = [&](const std::string& name) { return folder.file(name).string(); };
  CHECK(problem(sheet, R"(file="good.png")") == "none");
  CHECK_THAT(problem(sheet, R"(file="bad.png")"),
             Contains(file + path("bad.png") + ": the file is no PNG"));
  CHECK_THAT(problem(sheet, R"(file="none.png")"),
             Contains(file + path("none.png") + ": cannot read the file"));
  CHECK_THAT(problem(sheet, R"(file="text.npy")"),
             Contains(file + path("text.npy") + ": the file has 7 bytes"));
  CHECK_THAT(problem(R"(<mesh file="m.obj"/>)", R"(file="good.png")"),
             Contains(file + "vertex 1 has no (u,v), by which a picture is read"));
  CHECK_THAT(problem(R"(<mesh file="m.obj"/>)", R"(file="text.npy")"),
             Contains("a .npy has a number for each node of a grid, but the mesh is read as a "
                      "surface"));
  CHECK_THAT(problem(R"(<mesh file="m.obj"/>)", R"(attribute="x")"),
             Contains(file + path("m.obj")) &&
                 Contains("has no attribute \"x\"; only .ply, .gltf and .glb"));
  std::filesystem::create_directory(folder.file("d.png"));
  CHECK_THAT(problem(sheet, R"(file="d.png")"), Contains(file + path("d.png")));
}

TEST_CASE("a picture that does not fit in the memory allowed is refused", "[simulation][maps]") {
  const ScratchFolder folder;
  folder.write("m.png", grey_png(1200, 1200, std::vector<int>(1440000, 200)));
  Surface surface = sheet("s");
  surface.maps = {{.channel = MapChannel::B, .file = folder.file("m.png").string()}};
  CHECK(Simulation::make(scene({surface}, {}), {.max_memory = 8'000'000}));
  const auto refused = Simulation::make(scene({surface}, {}), {.max_memory = 2'000'000});
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::OutOfMemory);
}

TEST_CASE("vertices of one node have one value", "[simulation][maps]") {
  // A corner of one face gets a vertex of its own, in the place of the other.
  Surface surface = mixed_mesh();
  Mesh split = std::get<Mesh>(surface.shape);
  split.positions.conservativeResize(split.positions.rows() + 1, 3);
  const int first = 80;
  split.positions.row(split.positions.rows() - 1) = split.positions.row(first);
  *std::ranges::find(split.corner_vertices, first) = split.vertex_count() - 1;
  split.attributes = {
      {"m", std::vector<double>(static_cast<std::size_t>(split.vertex_count()), 1)}};
  surface.shape = split;
  surface.maps = {{.channel = MapChannel::D, .attribute = "m"}};
  CHECK(problem_of(scene({surface}, {})) == "none");
  split.attributes[0].values.back() = 2;
  surface.shape = split;
  CHECK_THAT(
      problem_of(scene({surface}, {})),
      Contains(fmt::format("s.map.d: m is 1 at vertex {} and 2 at vertex {}, but both are one "
                           "node, which has one value",
                           first, split.vertex_count() - 1)));
}

TEST_CASE("a live run checks its maps", "[simulation][maps][live]") {
  Surface surface = sheet("s");
  surface.maps = {map_of(surface, MapChannel::C, [](double x, double) { return 1 + 0.1 * x; })};
  auto live = LiveSimulation::make(scene({surface}, {press(5000)})).value();
  REQUIRE(live.advance());
  REQUIRE(live.set("s.poisson", 0.9));
  const auto refused = live.advance();
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("with a map of b, c or d"));
  REQUIRE(live.set("s.poisson", 0.1));
  CHECK(live.advance());
}

TEST_CASE("previews vibrate with their maps", "[simulation][maps]") {
  for (auto& [name, surface, force] : mapped_cases()) {
    CAPTURE(name);
    const Force pressing = force;
    const auto first_frequency = [&](const Surface& one) {
      const auto simulation = Simulation::make(scene({one}, {pressing})).value();
      const auto previews = preview_forces(simulation).value();
      REQUIRE_FALSE(previews.empty());
      REQUIRE_FALSE(previews[0].regions.empty());
      const RegionPreview& region = previews[0].regions[0];
      REQUIRE(region.has_vibration);
      return std::pair(region.first_frequency, region.damping_ratio);
    };
    const auto [plain, ratio] = first_frequency(surface);
    Surface heavy = surface, soft = surface, sticky = surface;
    heavy.maps = {even_map(heavy, MapChannel::Density, 4)};
    for (const MapChannel channel : {MapChannel::B, MapChannel::C, MapChannel::D})
      soft.maps.push_back(even_map(soft, channel, 0.25));
    sticky.maps = {even_map(sticky, MapChannel::Damping, 3)};
    CHECK(first_frequency(heavy).first == Approx(plain / 2).epsilon(1e-5));
    CHECK(first_frequency(soft).first == Approx(plain / 2).epsilon(1e-5));
    CHECK(first_frequency(sticky).first == Approx(plain).epsilon(1e-6));
    CHECK(first_frequency(sticky).second == Approx(3 * ratio).epsilon(1e-6));
    CHECK(first_frequency(heavy).second == Approx(ratio / 2).epsilon(1e-5));
  }
}
