#include "pliant/document/save_scene.hpp"

#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "files/animated_meshes.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/mesh/normals.hpp"
#include "pliant/pliant.hpp"
#include "support/caches.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/met_scenes.hpp"

namespace pliant {
namespace {

using namespace pliant::testing;
using Catch::Matchers::Contains;

// The content of each file of a folder, by name.
std::map<std::string, std::string> files_in(const ScratchFolder& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    files[entry.path().filename().string()] = read_file(entry.path()).value();
  return files;
}

std::set<std::string> names_in(const ScratchFolder& folder) {
  std::set<std::string> names;
  for (const auto& [name, content] : files_in(folder)) names.insert(name);
  return names;
}

// The scene as it was before some of it became files.
Scene without_files(Scene read, const Scene& made) {
  for (std::size_t k = 0; k < made.surfaces.size(); ++k) {
    Surface& surface = read.surfaces.at(k);
    const Surface& own = made.surfaces[k];
    const bool has_file = std::holds_alternative<MeshFile>(surface.shape);
    if (has_file) surface.shape = own.shape;
    if (!own.cache.samples.is_empty()) {
      CHECK_FALSE(surface.cache.path.empty());
      CHECK(surface.cache.first == own.cache.first);
      surface.cache = own.cache;
    }
    for (std::size_t n = 0; n < own.maps.size(); ++n) {
      if (own.maps[n].values.empty()) continue;
      CHECK(surface.maps.at(n).file.empty() == has_file);
      CHECK(surface.maps[n].attribute.empty() != has_file);
      surface.maps[n].file.clear();
      surface.maps[n].attribute.clear();
      surface.maps[n].values = own.maps[n].values;
    }
    for (std::size_t n = 0; n < own.holds.size(); ++n) {
      if (own.holds[n].values.empty()) continue;
      surface.holds.at(n).file.clear();
      surface.holds[n].attribute.clear();
      surface.holds[n].values = own.holds[n].values;
    }
  }
  for (std::size_t k = 0; k < made.colliders.size(); ++k)
    if (std::holds_alternative<ClosedMesh>(made.colliders[k].shape))
      read.colliders.at(k).shape = made.colliders[k].shape;
  return read;
}

// Saves a scene as a.xml, and checks that what is read is the same, and moves in the same way.
Scene saved(const ScratchFolder& folder, const Scene& made) {
  const std::string file = folder.file("a.xml").string();
  const auto written = save_scene(made, file);
  if (!written) FAIL(written.error().message);
  const auto read = load_scene(file);
  if (!read) FAIL(read.error().message);
  CHECK(without_files(*read, made) == made);
  CHECK(to_xml(*read, folder.path().string()).value() == read_file(file).value());
  auto expected = Simulation::make(made).value();
  auto found = Simulation::make(*read).value();
  double way = 0;
  for (const int frame : expected.frames()) {
    const Frame one = expected.at(frame).value();
    const Frame other = found.at(frame).value();
    for (std::size_t k = 0; k < made.surfaces.size(); ++k) {
      CHECK(other.surfaces()[k].positions() == one.surfaces()[k].positions());
      way = std::max(way, one.surfaces()[k].peak_displacement());
    }
  }
  CHECK(way > 1e-6);
  return *read;
}

Surface of_mesh(const std::string& name, Mesh mesh) {
  Surface surface = light(sheet(name));
  surface.shape = std::move(mesh);
  return surface;
}

Surface skin(const std::string& name, Mesh mesh) {
  Surface surface = of_mesh(name, std::move(mesh));
  surface.reading.uv = UvReading::Surface;
  return surface;
}

std::vector<double> ramp(int count, double first = 0.25) {
  std::vector<double> values;
  for (int k = 0; k < count; ++k) values.push_back(first + 1.0 / (3 + k));
  return values;
}

// The first vertex is above 0.5, no other one.
std::vector<double> first_of(int count) {
  std::vector<double> values(static_cast<std::size_t>(count), 0.1);
  values[0] = 0.7;
  return values;
}

Mesh uneven(int count = 5) {
  Mesh mesh = make_mesh({.columns = count, .rows = count, .width = 4, .depth = 4});
  for (int k = 0; k < mesh.vertex_count(); ++k) mesh.positions(k, 1) = 1.0 / (7 + k);
  return mesh;
}

Force push() {
  Force force = weight_of(0.1);
  force.name = "push";
  return force;
}

// The samples of a shape that rises more and more.
ShapeSamples rising(const Field& rest) {
  std::vector<Field> samples;
  for (int k = 0; k < 5; ++k) {
    samples.push_back(rest);
    samples.back().col(1).array() += 0.03 * k * k;
  }
  return ShapeSamples(std::move(samples));
}

Scene of(std::vector<Surface> surfaces) { return scene(std::move(surfaces), {push()}, 5); }

}  // namespace

TEST_CASE("a mesh without attributes is saved as .obj", "[document][save]") {
  const ScratchFolder folder;
  Mesh seamed = uneven();
  seamed.uvs.push_back({0.3, 1.0 / 3});
  seamed.uvs.push_back({9, 9});  // of no corner
  seamed.corner_uvs[7] = 25;
  seamed.corner_uvs[9] = -1;
  seamed.materials = {{"Skin red"}, std::vector<int>(16, 0)};
  saved(folder, of({of_mesh("grid", uneven()), skin("skin-2", seamed)}));
  CHECK(names_in(folder) == std::set<std::string>{"a.xml", "a.grid.obj", "a.skin-2.obj"});
}

TEST_CASE("attributes that nothing reads are not saved", "[document][save]") {
  const ScratchFolder folder;
  Mesh mesh = uneven();
  mesh.attributes = {{"never_read", ramp(25)}};
  saved(folder, of({skin("s", mesh)}));
  CHECK(names_in(folder) == std::set<std::string>{"a.xml", "a.s.obj"});
}

TEST_CASE("a mesh whose attributes are read is saved as .ply", "[document][save]") {
  const ScratchFolder folder;
  Mesh mesh = uneven();
  mesh.attributes = {{"soft", ramp(25)}, {"never_read", ramp(25)}, {"rim", first_of(25)}};
  mesh.uvs.push_back({0.3, 1.0 / 3});
  mesh.corner_uvs[7] = 25;
  Surface surface = skin("s", mesh);
  surface.maps = {{.channel = MapChannel::B, .attribute = "soft", .low = 0.5}};
  surface.holds = {{.attribute = "rim"}};
  const Scene read = saved(folder, of({surface}));
  CHECK(names_in(folder) == std::set<std::string>{"a.xml", "a.s.ply"});
  CHECK(read.surfaces[0].maps == surface.maps);
  CHECK(read.surfaces[0].holds == surface.holds);
}

TEST_CASE("a mesh whose normals no .obj keeps is saved as .ply", "[document][save]") {
  const ScratchFolder folder;
  Mesh mesh = make_mesh({.columns = 4, .rows = 3, .width = 3, .depth = 2});
  mesh.corner_normals = shared_normals(mesh, {{}, {}, {1, 1, 1, 2, 2, 2}}).value();
  const Scene made = of({of_mesh("s", mesh)});
  const Scene read = saved(folder, made);
  CHECK(names_in(folder) == std::set<std::string>{"a.xml", "a.s.ply"});
  const auto shape = Simulation::make(read).value().rest_shapes()[0];
  CHECK(shape.mesh.corner_normals == mesh.corner_normals);
}

TEST_CASE("values at the nodes of a grid are saved as .npy", "[document][save]") {
  const ScratchFolder folder;
  Surface flat = light(sheet("flat", 5)), round = light(sheet("round", 5));
  flat.shape = GridSheet{.columns = 5, .rows = 4, .width = 4, .depth = 3};
  flat.maps = {{.channel = MapChannel::Density, .high = 2, .values = ramp(20)},
               {.channel = MapChannel::C, .low = 0.5, .values = ramp(20, -0.0)}};
  flat.holds = {{.values = first_of(20)}, {.vertices = {3}}, {.above = 0.3, .values = ramp(20)}};
  round.reading.uv = UvReading::Surface;
  round.maps = {{.channel = MapChannel::D, .low = 0.5, .values = ramp(25)}};
  Surface net = light(sheet("net"));
  net.shape = NurbsNet{
      .u = {.count = 5, .degree = 2}, .v = {.count = 5, .degree = 2}, .points = uneven().positions};
  net.maps = {{.channel = MapChannel::Damping, .values = ramp(25)}};
  saved(folder, of({flat, round, net}));
  CHECK(names_in(folder) == std::set<std::string>{"a.xml", "a.flat.density.npy", "a.flat.c.npy",
                                                  "a.flat.hold.0.npy", "a.flat.hold.2.npy",
                                                  "a.round.d.npy", "a.net.damping.npy"});
}

TEST_CASE("values at the vertices of a mesh are attributes of its .ply", "[document][save]") {
  const ScratchFolder folder;
  Mesh mesh = uneven();
  mesh.attributes = {{"density", first_of(25)}, {"density_2", ramp(25)}};
  Surface grid = of_mesh("grid", mesh);
  grid.maps = {{.channel = MapChannel::Density, .low = 0.5, .values = ramp(25)},
               {.channel = MapChannel::B, .attribute = "density", .low = 0.5}};
  grid.holds = {{.values = first_of(25)}};
  Surface triangles = skin("skin", uneven());
  triangles.maps = {{.channel = MapChannel::Density, .low = 0.5, .values = ramp(25)}};
  const Scene read = saved(folder, of({grid, triangles}));
  CHECK(names_in(folder) == std::set<std::string>{"a.xml", "a.grid.ply", "a.skin.ply"});
  CHECK(read.surfaces[0].maps[0].attribute == "density_3");
  CHECK(read.surfaces[0].maps[1].attribute == "density");
  CHECK(read.surfaces[0].holds[0].attribute == "hold.0");
  CHECK(read.surfaces[1].maps[0].attribute == "density");

  // Also if the mesh is in a file, and again if it is the one that is replaced.
  Scene again = read;
  again.surfaces[1].maps.push_back({.channel = MapChannel::C, .low = 0.5, .values = ramp(25, 0.5)});
  saved(folder, again);
  CHECK(names_in(folder) == std::set<std::string>{"a.xml", "a.grid.ply", "a.skin.ply"});
}

TEST_CASE("samples that move a shape are saved as .npy", "[document][save]") {
  const ScratchFolder folder;
  Surface flat = light(sheet("flat", 5)), bent = skin("bent", uneven());
  flat.cache = {.first = 1.5, .samples = rising(sheet_vertices(5))};
  bent.cache.samples = rising(uneven().positions);
  Scene made = of({flat, bent});
  made.forces.push_back(sway());
  saved(folder, made);
  CHECK(names_in(folder) ==
        std::set<std::string>{"a.xml", "a.flat.cache.npy", "a.bent.obj", "a.bent.cache.npy"});
}

TEST_CASE("cages, driven surfaces and colliders are saved with their meshes", "[document][save]") {
  const ScratchFolder folder;
  Surface cage = skin("cage", uneven());
  if (has_opensubdiv()) cage.subdivision = Subdivision{.levels = 1};
  cage.maps = {{.channel = MapChannel::Density, .low = 0.5, .values = ramp(25)}};
  Surface proxy;
  proxy.name = "proxy";
  proxy.driven_by = "cage";
  proxy.shape = uneven(9);
  Mesh ball = sphere(2);
  Collider still =
      collider("ball", {.translate = vector_curve({{1, {0, 3, 0}}, {5, {0, 0.5, 0}}})});
  still.shape = ClosedMesh{.made = ball};
  Collider moving = collider("other", {.translate = Value<3>{0.5, -1.2, 0}});
  moving.shape = ClosedMesh{.cache = {.first = 0, .samples = rising(ball.positions)}, .made = ball};
  Scene made = of({cage, proxy});
  made.colliders = {still, moving};
  const Scene read = saved(folder, made);
  CHECK(names_in(folder) == std::set<std::string>{"a.xml", "a.cage.ply", "a.proxy.obj",
                                                  "a.ball.obj", "a.other.obj",
                                                  "a.other.cache.npy"});
  const auto& closed = std::get<ClosedMesh>(read.colliders[1].shape);
  CHECK(closed.cache.path == folder.file("a.other.cache.npy").string());
  CHECK(closed.cache.first == 0);
}

TEST_CASE("a scene with nothing in memory is one file", "[document][save]") {
  const ScratchFolder folder;
  saved(folder, of({light(sheet("s", 5))}));
  CHECK(names_in(folder) == std::set<std::string>{"a.xml"});
}

TEST_CASE("what no file contains is refused, and nothing is written", "[document][save]") {
  const ScratchFolder folder;
  const Scene sound = of({skin("s", uneven())});
  const auto check = [&](const std::function<void(Scene&)>& spoil, const std::string& expected) {
    CAPTURE(expected);
    Scene bad = sound;
    spoil(bad);
    const auto before = files_in(folder);
    const auto written = save_scene(bad, folder.file("a.xml").string());
    REQUIRE_FALSE(written);
    CHECK(written.error().code == ErrorCode::InvalidInput);
    CHECK_THAT(written.error().message, Contains(expected));
    CHECK(to_lines(written.error()).size() == 1);
    CHECK(files_in(folder) == before);
  };
  const auto check_all = [&] {
    check(
        [](Scene& s) {
          s.forces[0].kind = CustomForce{
              .unit_force = [](const Vector3d&, const ForceTime&) { return Vector3d(0, 1, 0); }};
        },
        "force \"push\" is custom");
    check(
        [](Scene& s) {
          s.forces[0].magnitude = curve({{1, 0}, {5, 2}});
          const SceneChange twice = parse_change("push.magnitude*=2").value();
          REQUIRE(make_changes(s, std::span(&twice, 1)));
        },
        "the curve of push.magnitude is adjusted");
    check([](Scene& s) { s.fps = -1; }, "fps is -1");
    check([](Scene& s) { std::get<Mesh>(s.surfaces[0].shape).positions(2, 0) = NAN; },
          "surface \"s\": vertex 2");
    check(
        [](Scene& s) {
          Mesh& mesh = std::get<Mesh>(s.surfaces[0].shape);
          mesh.materials = {{"Steel"}, std::vector<int>(16, 0)};
          s.surfaces[0].holds = {{.values = first_of(25)}};
        },
        "surface \"s\": the format .ply cannot keep these of the mesh as they are: materials");
    check([](Scene& s) { s.surfaces[0].holds = {{.values = first_of(24)}}; },
          "the attribute hold.0 has 24 values, but the mesh has 25 vertices");
    check(
        [](Scene& s) {
          s.surfaces[0] = sheet("s", 5);
          s.surfaces[0].maps = {{.values = ramp(24)}};
        },
        "s.density has 24 values, but the surface has 25 nodes");
    check(
        [](Scene& s) {
          s.surfaces[0] = sheet("s", 5);
          s.surfaces[0].maps = {{.values = std::vector<double>(25, INFINITY)}};
        },
        "s.density: value 0 is inf, which is not finite");
    check(
        [](Scene& s) {
          s.surfaces[0].cache.samples = ShapeSamples({Field::Zero(25, 3), Field::Zero(24, 3)});
        },
        "s.cache: sample 1 has 24 vertices");
    check(
        [](Scene& s) {
          s.colliders = {collider("c", {})};
          s.colliders[0].shape = ClosedMesh{.made = Mesh{}};
        },
        "collider \"c\": the mesh has no faces");
    check(
        [](Scene& s) {
          s.surfaces[0].cache = {.path = "a.npy", .samples = rising(Field::Zero(25, 3))};
        },
        "s.cache has a file and samples of a program");
  };
  check_all();
  CHECK(names_in(folder).empty());
  REQUIRE(save_scene(sound, folder.file("a.xml").string()));
  check_all();
}

TEST_CASE("a save that fails leaves all files as they were", "[document][save]") {
  const ScratchFolder folder;
  Scene made = of({skin("s", uneven()), skin("t", uneven())});
  REQUIRE(save_scene(made, folder.file("a.xml").string()));
  std::get<Mesh>(made.surfaces[0].shape).positions(3, 1) += 1;
  const auto before = files_in(folder);
  const auto nowhere = save_scene(made, folder.file("none/a.xml").string());
  REQUIRE_FALSE(nowhere);
  CHECK(nowhere.error().code == ErrorCode::Unwritable);
  for (const char* name : {"a.t.obj", "a.xml"}) {
    std::filesystem::remove(folder.file(name));
    std::filesystem::create_symlink("a.s.obj", folder.file(name));
    const auto link = save_scene(made, folder.file("a.xml").string());
    REQUIRE_FALSE(link);
    CHECK(link.error().file == folder.file(name).string());
    CHECK_THAT(link.error().message, Contains("symbolic link"));
    CHECK(folder.entry_count() == 3);
    CHECK(read_file(folder.file("a.s.obj")).value() == before.at("a.s.obj"));
    std::filesystem::remove(folder.file(name));
    folder.write(name, before.at(name));
  }
  int asked = 0;
  for (int most = 0;; ++most) {  // it ends at each time of asking
    asked = 0;
    const auto stopped =
        save_scene(made, folder.file("a.xml").string(), [&] { return ++asked > most; });
    if (stopped) break;
    CHECK(stopped.error().code == ErrorCode::Interrupted);
    CHECK(files_in(folder) == before);
  }
  CHECK(files_in(folder) != before);
  CHECK(folder.entry_count() == 3);
}

TEST_CASE("a save replaces its own files, and none that the scene reads", "[document][save]") {
  const ScratchFolder folder;
  Scene made = of({skin("s", uneven()), skin("t", uneven())});
  const std::string file = folder.file("a.xml").string();
  saved(folder, made);
  folder.write("a.other.obj", "not of this scene");
  std::get<Mesh>(made.surfaces[0].shape).positions(3, 1) += 1;
  saved(folder, made);
  CHECK(names_in(folder) == std::set<std::string>{"a.xml", "a.s.obj", "a.t.obj", "a.other.obj"});
  CHECK(read_file(folder.file("a.other.obj")).value() == "not of this scene");

  // What was t is in the file of s.
  Scene turned = load_scene(file).value();
  turned.surfaces[0].name = "t";
  turned.surfaces[1].name = "s";
  turned.surfaces[1].shape = uneven();
  const auto before = files_in(folder);
  const auto refused = save_scene(turned, file);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::InvalidInput);
  CHECK(refused.error().file == folder.file("a.s.obj").string());
  CHECK_THAT(refused.error().message, Contains("because it is a mesh of the scene"));
  CHECK(files_in(folder) == before);
  // So it is by another name.
  std::filesystem::create_directory(folder.file("sub"));
  std::get<MeshFile>(turned.surfaces[0].shape).path = folder.file("sub/../a.s.obj").string();
  CHECK_FALSE(save_scene(turned, file));
  turned.surfaces[0].shape = uneven();
  std::filesystem::remove(folder.file("sub"));
  saved(folder, turned);
}

TEST_CASE("names without an ending, and in the folder that is current", "[document][save]") {
  const ScratchFolder folder;
  const Scene made = of({skin("s", uneven())});
  REQUIRE(save_scene(made, folder.file("bare").string()));
  REQUIRE(save_scene(made, folder.file("two.dots.xml").string()));
  CHECK(names_in(folder) ==
        std::set<std::string>{"bare", "bare.s.obj", "two.dots.xml", "two.dots.s.obj"});
  CHECK(without_files(load_scene(folder.file("bare").string()).value(), made) == made);
  const auto here = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  const auto written = save_scene(made, "b.xml");
  const auto read = load_scene("b.xml");
  std::filesystem::current_path(here);
  REQUIRE(written);
  REQUIRE(read);
  CHECK(without_files(*read, made) == made);
  CHECK_THAT(read_file(folder.file("b.xml")).value(), Contains("file=\"b.s.obj\""));
}

}  // namespace pliant
