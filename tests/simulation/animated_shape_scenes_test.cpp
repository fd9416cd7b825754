#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "pliant/scene/checks/check.hpp"
#include "pliant/states/state_store.hpp"
#include "support/caches.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"

using namespace pliant;
using namespace pliant::testing;

// Scenes whose shapes at rest move: `cache`. SPEC 9.

namespace {

// A way that neither begins nor ends at rest.
Vector3d way_at(int frame) {
  const double t = frame;
  return {0.4 * t + 0.01 * t * t, 0.02 * t * t * t / 10, -0.3 * t + 0.003 * t * t * t};
}

std::vector<Field> carried(const Field& rest, int first, int last) {
  std::vector<Field> samples;
  for (int frame = first; frame <= last; ++frame) {
    samples.push_back(rest.rowwise() + way_at(frame).transpose());
  }
  return samples;
}

// Each vertex moves by itself: a wave that grows.
std::vector<Field> waving(const Field& rest, int count) {
  std::vector<Field> samples;
  for (int k = 0; k < count; ++k) {
    Field field = rest;
    for (Eigen::Index row = 0; row < rest.rows(); ++row) {
      field(row, 1) += 0.05 * k * std::sin(0.7 * rest(row, 0) + 0.5 * k) + 0.01 * k * k;
      field(row, 0) += 0.02 * k;
    }
    samples.push_back(field);
  }
  return samples;
}

Surface whole(Surface surface) {
  surface.solver.region = SolvedRegion::All;
  return surface;
}

Surface animated(Surface surface, const std::string& cache, double first) {
  surface.cache = {cache, first};
  return surface;
}

// A key at each frame, between which the value goes linearly.
Curve<3> linear(int first, int last, Vector3d (*at)(int)) {
  CurveKeys<3> keys;
  for (int frame = first; frame <= last; ++frame) {
    const Vector3d value = at(frame);
    Key<3> key{.frame = double(frame), .value = {value[0], value[1], value[2]}};
    key.next.kind = Interpolation::Kind::Linear;
    keys.keys.push_back(key);
  }
  return Curve<3>::make(std::move(keys)).value();
}

// The surface at all frames.
std::vector<SurfaceFrame> frames_of(const Scene& scene, const SimulationOptions& options = {}) {
  auto simulation = Simulation::make(scene, options).value();
  std::vector<SurfaceFrame> frames;
  for (const int frame : simulation.frames())
    frames.push_back(simulation.at(frame).value().surfaces()[0]);
  return frames;
}

Surface as_triangles(Surface surface) {
  surface.reading.uv = UvReading::Surface;
  return surface;
}

Surface of_mesh(const std::string& name, Mesh mesh) {
  Surface surface = sheet(name);
  surface.shape = std::move(mesh);
  return surface;
}

Mesh sheet_mesh() { return make_mesh(std::get<GridSheet>(sheet("s").shape)); }

}  // namespace

TEST_CASE("a body that its cache carries moves like one that its transform carries",
          "[simulation][cache]") {
  const ScratchFolder folder;
  const int kind = GENERATE(0, 1, 2, 3);
  CAPTURE(kind);
  Surface plain = sheet("s");
  if (kind == 1) plain = as_triangles(of_mesh("s", sheet_mesh()));
  if (kind == 2) plain = whole(plain);
  if (kind == 3) plain.solver.release = Release::Recover;
  Surface carried_by_cache =
      animated(plain, write_cache(folder, "way.npy", carried(sheet_vertices(), 0, 14)), 0);
  Surface carried_by_transform = plain;
  carried_by_transform.transform.translate = linear(0, 14, way_at);
  Force push = poke("push", {});
  push.kind = PointChannels{.center = linear(0, 14, way_at)};
  push.enabled = switch_at({{1, true}, {6, false}});
  std::vector<Force> forces = {push};
  if (kind != 3) forces.push_back(sway());
  const auto by_cache = frames_of(scene({carried_by_cache}, forces));
  const auto by_transform = frames_of(scene({carried_by_transform}, forces));
  double peak = 0, apart = 0;
  for (std::size_t k = 0; k < by_cache.size(); ++k) {
    apart =
        std::max(apart, largest_difference(by_cache[k].positions(), by_transform[k].positions()));
    peak = std::max(peak, by_transform[k].peak_displacement());
    CHECK_THAT(by_cache[k].peak_displacement(),
               WithinAbs(by_transform[k].peak_displacement(), 1e-11));
  }
  CHECK(peak > 0.1);
  CHECK(apart <= 1e-12 * std::max(peak, 10.0));  // the way itself is about 10 long
}

TEST_CASE("a cache that stands still is no cache, but for rounding", "[simulation][cache]") {
  const ScratchFolder folder;
  const std::string cache = write_cache(folder, "still.npy", {sheet_vertices(), sheet_vertices()});
  for (const Release release : {Release::Freeze, Release::Recover}) {
    Surface plain = sheet("s");
    plain.solver.release = release;
    Force push = poke("push", {1, 0, -2});
    push.enabled = switch_at({{1, true}, {4, false}, {9, true}});
    const auto expected = baked(scene({plain}, {push, sway()}), "s");
    const auto found = baked(scene({animated(plain, cache, 3)}, {push, sway()}), "s");
    CHECK(peak(expected) > 0.1);
    for (std::size_t k = 0; k < expected.size(); ++k)
      CHECK(largest_difference(found[k], expected[k]) <= 1e-13 * peak(expected));
  }
}

TEST_CASE("an even motion of a cache exerts nothing, nor does any motion without inertia",
          "[simulation][cache]") {
  const ScratchFolder folder;
  std::vector<Field> even, any = waving(sheet_vertices(), 20);
  for (int k = 0; k < 6; ++k)
    even.push_back(sheet_vertices().rowwise() + Eigen::RowVector3d(k, 2 * k, 0));
  const auto check_still = [](const Scene& scene, const std::vector<Field>& samples) {
    auto simulation = Simulation::make(scene).value();
    for (const int frame : simulation.frames()) {
      CAPTURE(frame);
      const SurfaceFrame shown = simulation.at(frame).value().surfaces()[0];
      const int sample = std::clamp(frame - 3, 0, static_cast<int>(samples.size()) - 1);
      CHECK(shown.peak_displacement() == 0);
      CHECK(shown.positions() == samples[static_cast<std::size_t>(sample)]);
    }
  };
  const Surface by_any = animated(whole(sheet("s")), write_cache(folder, "any.npy", any), 3);
  check_still(scene({by_any}, {}, 20), any);
  // Frames 3 to 8 have samples: a body enters and leaves them at its speed.
  const Surface by_even = animated(whole(sheet("s")), write_cache(folder, "even.npy", even), 3);
  check_still(scene({by_even}, {sway()}, 14), even);
}

TEST_CASE("the inertia of an animated shape is that of its points in the world",
          "[simulation][cache]") {
  // One interior node, so that its equation can be written down: 3 x 3 nodes.
  const ScratchFolder folder;
  const Field rest = sheet_vertices(3);
  std::vector<Field> samples;
  for (int frame = 0; frame <= 9; ++frame) {
    Field sample = rest;
    sample.row(4) += Eigen::RowVector3d(0.1 * frame * frame, 0.03 * frame * frame * frame, 0.2);
    samples.push_back(sample);
  }
  Surface surface = animated(sheet("s", 3), write_cache(folder, "a.npy", samples), 0);
  surface.solver.dt = 1;  // one step a frame
  surface.solver.measure = GENERATE(Measure::Current, Measure::Rest);
  surface.transform.translate = vector_curve({{0, {0, 0, 0}}, {5, {3, 1, -2}}, {9, {0, 4, 0}}});
  surface.transform.rotate = vector_curve({{0, {0, 0, 0}}, {5, {50, 20, 5}}, {9, {10, 90, 7}}});
  const Scene s = scene({surface}, {sway()}, 8);
  auto simulation = Simulation::make(s).value();
  const double rho = 40, eta = 20, length = 1.0 / 24, stiffness = 8 + 4 * 2 + 8;
  const double h4 = std::pow(0.5, 4);  // 3 columns over [0,1]
  Vector3d w = {0, 0, 0}, v = {0, 0, 0};
  const auto transform_at = [&](int frame) {
    const auto vector = [&](const Channel<3>& channel) {
      const Value<3> value = channel.at(frame);
      return Vector3d(value[0], value[1], value[2]);
    };
    return make_transform(vector(surface.transform.translate), vector(surface.transform.rotate),
                          {1, 1, 1}, RotateOrder::Xyz);
  };
  for (int frame = 1; frame <= 8; ++frame) {
    CAPTURE(frame);
    const Field shown = simulation.at(frame).value().surfaces()[0].object_positions();
    const Vector3d found = (shown.row(4) - samples[static_cast<std::size_t>(frame)].row(4));
    CHECK(largest_difference(found.transpose(), w.transpose()) <= 1e-10);
    const auto point = [&](int of) {
      const Vector3d own = surface.solver.measure == Measure::Rest ? Vector3d(0, 0, 0) : w;
      return to_world(transform_at(of),
                      Vector3d(samples[static_cast<std::size_t>(of)].row(4).transpose() + own));
    };
    const Vector3d world =
        -rho * (point(frame + 1) - 2 * point(frame) + point(frame - 1)) / (length * length);
    const Vector3d load = inverse_linear(transform_at(frame)) * world;
    const double own = rho / (length * length) + eta / length;
    const Vector3d next = (load + own * w + rho / length * v) / (own + stiffness / h4);
    v = (next - w) / length;
    w = next;
  }
}

TEST_CASE("forces find an animated shape where it is", "[simulation][cache]") {
  const ScratchFolder folder;
  // It comes to the force.
  std::vector<Field> samples;
  for (int k = 0; k < 12; ++k)
    samples.push_back(sheet_vertices().rowwise() + Eigen::RowVector3d(30 - 3 * k, 0, 0));
  const std::string cache = write_cache(folder, "a.npy", samples);
  for (const Measure measure : {Measure::Current, Measure::Rest}) {
    for (const bool has_triangles : {false, true}) {
      Surface surface = has_triangles ? as_triangles(of_mesh("s", sheet_mesh())) : sheet("s");
      surface.solver.measure = measure;
      auto simulation =
          Simulation::make(scene({animated(surface, cache, 1)}, {poke("p", {0, 0, 0}, 9e4)}))
              .value();
      // At frame f its nodes begin at x = 30 - 3 (f - 1) - 6; the force selects what is nearer
      // than 4.5.
      for (const int frame : {2, 5, 7, 8, 9, 11}) {
        CAPTURE(frame, has_triangles);
        const double near = 30 - 3 * (frame - 1) - 6;
        const FrameReport report = simulation.report(frame).value();
        // A grid needs a node between two on the rim.
        CHECK(report.surfaces[0].is_solved == (near + (has_triangles ? 1 : 2) < 4.5));
      }
      CHECK(simulation.at(5).value().surfaces()[0].peak_displacement() == 0);
      CHECK(simulation.at(12).value().surfaces()[0].peak_displacement() > 0.1);
    }
  }
}

TEST_CASE(
    "an animated scene is the same at random frames, from stores, from checkpoints, on "
    "threads and live",
    "[simulation][cache][threads]") {
  const ScratchFolder folder;
  const std::string cache = write_cache(folder, "a.npy", waving(sheet_vertices(), 12));
  Surface triangles = as_triangles(of_mesh("t", sheet_mesh()));
  triangles.solver.release = Release::Recover;
  Force push = poke("push", {1, 0, 0});
  push.enabled = switch_at({{1, true}, {5, false}});
  const Scene s = scene({animated(whole(sheet("s")), cache, 0.5), animated(triangles, cache, 2)},
                        {push, sway()});
  const auto all = [](const Frame& frame) {
    return std::pair(frame.surfaces()[0].positions(), frame.surfaces()[1].positions());
  };
  auto simulation = Simulation::make(s).value();
  std::vector<std::pair<Field, Field>> expected;
  for (const int frame : simulation.frames()) expected.push_back(all(simulation.at(frame).value()));
  CHECK(largest_difference(expected[11].first, sheet_vertices()) > 0.1);
  const auto at = [&](int frame) { return expected[static_cast<std::size_t>(frame - 1)]; };

  auto random = Simulation::make(s, {.threads = 3}).value();
  for (const int frame : {12, 3, 7, 1, 11, 6}) CHECK(all(random.at(frame).value()) == at(frame));

  MemoryStateStore store(1 << 24);
  for (int run = 0; run < 2; ++run) {
    auto stored = Simulation::make(s, {.store = &store}).value();
    for (const int frame : {4, 12}) CHECK(all(stored.at(frame).value()) == at(frame));
    CHECK((stored.frame_counts().solved == 0) == (run == 1));
  }

  const std::string bytes = simulation.state_bytes(7).value();
  auto continued = Simulation::make(s).value();
  CHECK(continued.restore(bytes).value() == 7);
  CHECK(all(continued.at(10).value()) == at(10));

  auto live = LiveSimulation::make(s).value();
  for (int frame = 1; frame < 12; ++frame) {
    CHECK(all(live.positions().value()) == at(frame));
    REQUIRE(live.advance());
  }
}

TEST_CASE("samples of a program move as those of a file, and find their states",
          "[simulation][cache]") {
  const ScratchFolder folder;
  const std::vector<Field> samples = waving(sheet_vertices(), 9);
  const std::string file = write_cache(folder, "a.npy", samples);
  Surface grid = whole(sheet("s"));
  if (GENERATE(false, true)) grid = as_triangles(of_mesh("s", sheet_mesh()));
  if (GENERATE(false, true)) {
    grid.solver.loop = 6;
    grid.solver.region = SolvedRegion::Forces;
  }
  const std::optional<double> first =
      GENERATE(std::optional<double>(), std::optional<double>(2.25));
  grid.cache = {file, first};
  Scene by_file = scene({grid}, {sway()}), by_program = by_file;
  by_program.surfaces[0].cache = {.first = first, .samples = ShapeSamples(samples)};
  CHECK_FALSE(by_file == by_program);
  MemoryStateStore store(1 << 24);
  auto expected = Simulation::make(by_file, {.store = &store}).value();
  auto found = Simulation::make(by_program, {.store = &store}).value();
  for (const int frame : expected.frames()) {
    const Field of_file = expected.at(frame).value().surfaces()[0].positions();
    CHECK(found.at(frame).value().surfaces()[0].positions() == of_file);
  }
  CHECK(expected.frame_counts().solved > 0);
  CHECK(found.frame_counts().solved == 0);
}

TEST_CASE("a cache of a file and of a program is refused, and copies share samples",
          "[simulation][cache]") {
  Scene s = scene({sheet("s")}, {});
  s.surfaces[0].cache.samples = ShapeSamples({sheet_vertices()});
  const Scene copy = s;
  CHECK(&copy.surfaces[0].cache.samples[0] == &s.surfaces[0].cache.samples[0]);
  CHECK(check_scene(s).empty());
  s.surfaces[0].cache.path = "a.npy";
  s.colliders = {{.name = "c", .shape = ClosedMesh{.cache = s.surfaces[0].cache}}};
  const auto problems = check_scene(s);
  for (const char* name : {"s", "c"}) {
    CHECK(std::ranges::any_of(problems, [&](const Error& problem) {
      return problem.message == fmt::format(
                                    "{}.cache has a file and samples of a program, but "
                                    "must have one of them",
                                    name);
    }));
  }
}

TEST_CASE("states depend on all frames of a cache that act", "[simulation][cache]") {
  const ScratchFolder folder;
  auto samples = waving(sheet_vertices(), 9);
  const std::string cache = write_cache(folder, "a.npy", samples);
  samples[5](40, 1) += 0.001;  // at frame 6
  const std::string other = write_cache(folder, "b.npy", samples);
  const auto bytes_at = [&](const std::string& file, bool has_inertia, int frame) {
    const Surface surface = animated(whole(sheet("s")), file, 1);
    const Scene s =
        scene({surface}, has_inertia ? std::vector<Force>{sway()} : std::vector<Force>{});
    return Simulation::make(s).value().state_bytes(frame).value();
  };
  // The solve at frame 5 reads frame 6 for its inertia only; the one at frame 6 its shape too.
  CHECK(bytes_at(cache, true, 5) == bytes_at(other, true, 5));
  CHECK(bytes_at(cache, true, 6) != bytes_at(other, true, 6));
  CHECK(bytes_at(cache, false, 6) == bytes_at(other, false, 6));
  CHECK(bytes_at(cache, false, 7) != bytes_at(other, false, 7));
}

TEST_CASE("a loop reads its cache at the frames of the cycle, without a seam",
          "[simulation][cache]") {
  // A wave that comes again after 6 frames; what the file has besides is never read.
  const ScratchFolder folder;
  std::vector<Field> samples;
  for (int k = 0; k < 6; ++k) {
    Field field = sheet_vertices();
    for (Eigen::Index row = 0; row < field.rows(); ++row)
      field(row, 1) += 0.3 * std::sin(0.7 * field(row, 0) + std::acos(-1.0) * k / 3);
    samples.push_back(field);
  }
  std::vector<Field> many, once = samples;
  for (int k = 0; k < 40 * 6; ++k) many.push_back(samples[static_cast<std::size_t>(k % 6)]);
  once.insert(once.begin(), Field::Constant(samples[0].rows(), 3, 77));
  once.push_back(Field::Constant(samples[0].rows(), 3, 99));
  Surface looped = animated(whole(sheet("s")), write_cache(folder, "once.npy", once), 0);
  looped.solver.loop = 6;
  looped.material.damping = 200.0;
  Surface played = animated(whole(sheet("s")), write_cache(folder, "many.npy", many), 1);
  played.material.damping = 200.0;
  // Frame 1 + 6 k of a run that has gone round often shows the cycle's beginning.
  const auto cycle = baked(scene({looped}, {sway()}, 14), "s");
  const auto run = baked(scene({played}, {sway()}, 39 * 6 + 1), "s");
  double moved = 0;
  for (std::size_t k = 0; k < 14; ++k) {
    CAPTURE(k);
    const std::size_t late = 37 * 6 + k % 6;
    CHECK(largest_difference(cycle[k], run[late]) <= 1e-5);
    moved = std::max(moved, largest_difference(cycle[k], samples[k % 6]));
  }
  CHECK(moved > 0.01);
}

TEST_CASE("a surface that is disabled or starts later rides with its cache",
          "[simulation][cache]") {
  const ScratchFolder folder;
  const auto samples = waving(sheet_vertices(), 12);
  Surface surface = animated(sheet("s"), write_cache(folder, "a.npy", samples), 1);
  surface.solver.start_frame = 9;
  surface.enabled = GENERATE(true, false);
  const auto frames = baked(scene({surface}, {poke("p", {0, 0, 0}, 1e4)}), "s");
  for (std::size_t k = 0; k < 12; ++k) {
    CAPTURE(k);
    CHECK((frames[k] == samples[k]) == (k < 9 || !surface.enabled));
  }
}

TEST_CASE("what is frozen rides with its cache", "[simulation][cache]") {
  const ScratchFolder folder;
  const auto samples = carried(sheet_vertices(), 1, 12);
  Surface surface = animated(sheet("s"), write_cache(folder, "a.npy", samples), 1);
  Force push = poke("push", {way_at(1)[0], way_at(1)[1], way_at(1)[2]}, 2e4);
  push.enabled = switch_at({{1, true}, {2, false}});
  const auto frames = baked(scene({surface}, {push}), "s");
  const Field dent = frames[1] - samples[1];
  CHECK(dent.cwiseAbs().maxCoeff() > 0.01);
  for (std::size_t k = 2; k < 12; ++k)
    CHECK(largest_difference(frames[k] - samples[k], dent) <= 1e-13);
}

TEST_CASE("vertices keep the offsets that their cache gives them", "[simulation][cache]") {
  // Twins at a seam: one node on triangles, whose vertices the cache moves apart.
  const ScratchFolder folder;
  Mesh mesh = square(6, 6, 0.3);
  mesh.positions.conservativeResize(mesh.positions.rows() + 2, 3);
  const Eigen::Index twin = mesh.positions.rows() - 2, loose = twin + 1;
  const int of = 24;  // in the middle
  mesh.positions.row(twin) = mesh.positions.row(of);
  mesh.positions.row(loose) << 9, 9, 9;
  *std::ranges::find(mesh.corner_vertices, of) = static_cast<int>(twin);
  auto samples = waving(mesh.positions, 12);
  for (std::size_t k = 0; k < 12; ++k) samples[k](twin, 2) += 0.01 * static_cast<double>(k);
  const Surface surface =
      animated(whole(of_mesh("s", mesh)), write_cache(folder, "a.npy", samples), 1);
  const auto frames = baked(scene({surface}, {sway()}), "s");
  CHECK((frames[11].row(of) - samples[11].row(of)).norm() > 1e-3);
  for (std::size_t k = 0; k < 12; ++k) {
    const Eigen::RowVector3d node = frames[k].row(of) - samples[k].row(of);
    CHECK((frames[k].row(twin) - samples[k].row(twin) - node).norm() <= 1e-14);
    CHECK(frames[k].row(loose) == samples[k].row(loose));
  }
}

TEST_CASE("a subdivision refines its animated cage, and a proxy follows it",
          "[simulation][cache]") {
  const ScratchFolder folder;
  const Mesh cage = sheet_mesh();
  const std::string cache = write_cache(folder, "a.npy", carried(cage.positions, 0, 14));
  Surface plain = whole(of_mesh("s", cage));
  Surface skin = of_mesh("skin", square(20, 10, 0.3));
  skin.driven_by = "s";
  skin.material = {};
  const bool is_finer = GENERATE(false, true);
  if (is_finer) plain.subdivision = Subdivision{.levels = 1};
  Surface by_transform = plain, by_cache = animated(plain, cache, 0);
  by_transform.transform.translate = linear(0, 14, way_at);
  // The skin follows its driver's displacement from its place at the start.
  Surface carried_skin = skin;
  carried_skin.transform.translate = linear(0, 14, way_at);
  skin.transform.translate = Value<3>{way_at(1)[0], way_at(1)[1], way_at(1)[2]};
  const std::vector<Force> forces = {sway()};
  for (const char* name : {"s", "skin"}) {
    const auto found = baked(scene({by_cache, skin}, forces), name);
    const auto expected = baked(scene({by_transform, carried_skin}, forces), name);
    for (std::size_t k = 0; k < found.size(); ++k)
      CHECK(largest_difference(found[k], expected[k]) <= 1e-11);
  }
}

TEST_CASE("a closed grid is animated too", "[simulation][cache]") {
  const ScratchFolder folder;
  Mesh tube = make_mesh({.columns = 13, .rows = 7, .width = 1, .depth = 4});
  for (Eigen::Index k = 0; k < tube.positions.rows(); ++k) {
    const double angle = 2 * std::acos(-1.0) * static_cast<double>(k % 13 % 12) / 12;
    tube.positions.row(k) << 2 * std::cos(angle), 2 * std::sin(angle), tube.positions(k, 2);
  }
  Surface plain = of_mesh("s", tube);
  plain.reading.wrap = Wrap::U;
  plain.solver.region = SolvedRegion::All;
  Surface by_transform = plain;
  by_transform.transform.translate = linear(0, 14, way_at);
  const Surface by_cache =
      animated(plain, write_cache(folder, "a.npy", carried(tube.positions, 0, 14)), 0);
  const auto found = baked(scene({by_cache}, {sway()}), "s");
  const auto expected = baked(scene({by_transform}, {sway()}), "s");
  CHECK(peak(expected) > 0.1);
  for (std::size_t k = 0; k < found.size(); ++k)
    CHECK(largest_difference(found[k], expected[k]) <= 1e-11);
}

TEST_CASE("caches that mean nothing are refused by name", "[simulation][cache]") {
  using Catch::Matchers::Contains;
  const auto refusal = [](const std::string& surface, const std::string& more = "") {
    const auto scene = parse_scene(
        fmt::format("<scene start=\"1\" end=\"3\"><surface name=\"s\">{}</surface>{}</scene>",
                    surface, more),
        "scene.xml", "");
    REQUIRE_FALSE(scene);
    CHECK(scene.error().line == 1);
    return to_lines(scene.error()).front();
  };
  const std::string grid = "<grid columns=\"4\" rows=\"4\" cache=\"a.npy\"/>";
  CHECK_THAT(refusal(grid + "<solver reference=\"none\"/>"),
             Contains("s.reference") && Contains("cache") && Contains("reference=\"none\""));
  CHECK_THAT(refusal("<grid columns=\"4\" rows=\"4\" cacheStart=\"3\"/>"),
             Contains("s.cacheStart is given, but no cache"));
  CHECK_THAT(refusal("<grid columns=\"4\" rows=\"4\"/>",
                     "<surface name=\"d\" drivenBy=\"s\"><grid columns=\"4\" rows=\"4\" "
                     "cache=\"a.npy\"/></surface>"),
             Contains("d.cache") && Contains("driven by \"s\""));
  CHECK_THAT(refusal("<nurbs columns=\"4\" rows=\"4\" degreeU=\"1\" degreeV=\"1\" cache=\"a.npy\">"
                     "</nurbs>"),
             Contains("cache"));
  Surface net = sheet("s");
  net.shape = NurbsNet{};
  net.cache.path = "a.npy";
  const auto problems = check_scene(scene({net}, {}));
  CHECK(std::ranges::any_of(problems, [](const Error& problem) {
    return problem.message.find("a net, but a cache") != std::string::npos;
  }));
}

TEST_CASE("a cache without a sample within the scene is one warning, before any frame",
          "[simulation][cache]") {
  const ScratchFolder folder;
  const int count = 4, end = 9;  // frames 1 to 9
  const std::string cache = write_cache(folder, "a.npy", waving(sheet_vertices(), count));
  for (const double first : {-40.0, -3.0, -2.25, -2.0, 1.0, 9.0, 9.25, 10.0, 1000.0}) {
    CAPTURE(first);
    const auto simulation =
        Simulation::make(scene({animated(sheet("s"), cache, first)}, {}, end)).value();
    const bool is_within = first + count - 1 >= 1 && first <= end;
    const std::vector<Warning> warnings = simulation.warnings();
    REQUIRE(warnings.size() == (is_within ? 0 : 1));
    if (is_within) continue;
    CHECK(warnings[0].kind == Warning::Kind::CacheOutside);
    CHECK_THAT(warnings[0].message(),
               Catch::Matchers::Contains(first < 1 ? "before its frames" : "after its frames") &&
                   Catch::Matchers::Contains(
                       fmt::format("at frames {:.6g} to {:.6g}", first, first + count - 1)));
  }
}
