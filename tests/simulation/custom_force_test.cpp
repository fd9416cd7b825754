#include <atomic>
#include <cmath>
#include <span>
#include <vector>

#include "pliant/forces/force.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

using Points = std::span<const Vector3d>;

// What a program's functions were asked for.
struct Asked {
  std::atomic<int> calls = 0;
  std::atomic<int> positions = 0;

  void note(Points points) {
    ++calls;
    positions += static_cast<int>(points.size());
  }
};

CustomForce of_one(const ForceKind& kind) {
  return {
      .distance = [kind](const Vector3d& p, const ForceTime&) { return distance(kind, p); },
      .unit_force = [kind](const Vector3d& p, const ForceTime&) { return unit_force(kind, p); }};
}

CustomForce of_many(const ForceKind& kind, Asked& asked) {
  return {.distance =
              [kind, &asked](Points points, const ForceTime&, std::span<double> values) {
                asked.note(points);
                for (std::size_t k = 0; k < points.size(); ++k)
                  values[k] = distance(kind, points[k]);
              },
          .unit_force =
              [kind, &asked](Points points, const ForceTime&, std::span<Vector3d> values) {
                asked.note(points);
                for (std::size_t k = 0; k < points.size(); ++k)
                  values[k] = unit_force(kind, points[k]);
              }};
}

// Kinds whose sampled values are known.
struct Kind {
  ForceKind sampled;
  Force force;
};

std::vector<Kind> kinds() {
  std::vector<Kind> all;
  const auto add = [&](const ForceKind& sampled, const auto& channels) {
    Kind& one = all.emplace_back();
    one.sampled = sampled;
    one.force = poke("f" + std::to_string(all.size()), {0, 0, 0}, 900);
    one.force.kind = channels;
    one.force.deformation_radius = 3.1;
    one.force.force_radius = 2.2;
    one.force.falloff = all.size() % 2 ? Falloff::Smooth : Falloff::Linear;
  };
  add(PointForce{{-2.1, 0, 0.4}, {0.2, 1, 0}},
      PointChannels{.center = Value<3>{-2.1, 0, 0.4}, .direction = Value<3>{0.2, 1, 0}});
  add(RadialForce{{3, -1, 3.2}}, RadialChannels{.center = Value<3>{3, -1, 3.2}});
  add(VortexForce{{4, 0, -4}, {0, 1, 0.1}, 0.3},
      VortexChannels{.center = Value<3>{4, 0, -4}, .axis = Value<3>{0, 1, 0.1}, .pull = 0.3});
  return all;
}

enum class Form { BuiltIn, One, Many };

std::vector<Force> forces(Form form, Asked& asked) {
  std::vector<Force> all;
  for (const Kind& kind : kinds()) {
    all.push_back(kind.force);
    if (form == Form::One) all.back().kind = of_one(kind.sampled);
    if (form == Form::Many) all.back().kind = of_many(kind.sampled, asked);
  }
  return all;
}

struct Run {
  std::vector<Field> frames;
  std::vector<Vector3d> pushes;
  std::vector<int> pushed;
  std::vector<double> peaks;

  friend bool operator==(const Run&, const Run&) = default;
};

Run run(const Scene& scene, int threads) {
  auto simulation = Simulation::make(scene, {.threads = threads}).value();
  Run found;
  for (const int frame : simulation.frames()) {
    const Frame at = simulation.at(frame).value();
    for (const SurfaceFrame& surface : at.surfaces()) found.frames.push_back(surface.positions());
    const FrameReport report = simulation.report(frame).value();
    for (const SurfaceReport& surface : report.surfaces) {
      for (const ForceReport& force : surface.forces) {
        found.pushes.push_back(force.push.sum);
        found.pushed.push_back(force.push.node_count);
      }
    }
  }
  const std::vector<Preview> previews = preview_forces(simulation).value();
  for (const Preview& preview : previews) found.peaks.push_back(preview.static_peak);
  return found;
}

// A surface of triangles and faces of four.
Surface skin(Border border = Border::Clamped) {
  Surface surface;
  surface.name = "s";
  surface.shape = square(13, 12, 0.2, true);
  surface.reading.uv = UvReading::Surface;
  surface.reading.border = border;
  surface.material.density = 40.0;
  surface.material.damping = 20.0;
  return surface;
}

// How surfaces select and are measured.
std::vector<Surface> surfaces() {
  std::vector<Surface> all;
  for (const Combine how : {Combine::Box, Combine::Union, Combine::Islands}) {
    all.push_back(sheet("s", 13));
    all.back().solver.combine = how;
  }
  all.push_back(sheet("s", 13));
  all.back().solver.region = SolvedRegion::All;
  all.back().solver.measure = Measure::Rest;
  all.push_back(skin());
  all.push_back(skin());
  all.back().solver.measure = Measure::Current;
  return all;
}

}  // namespace

TEST_CASE("a force of many positions has the bits of one position, and of the same force built in",
          "[simulation][custom][threads]") {
  Asked asked;
  const auto made = [&](const Surface& surface, Form form) {
    Scene s = scene({surface, surface}, forces(form, asked), 5);
    s.surfaces[1].name = "t";
    s.forces.insert(s.forces.begin() + 1, poke("other", {1, 0, -1}, -700));
    return s;
  };
  for (const Surface& surface : surfaces()) {
    const Run expected = run(made(surface, Form::BuiltIn), 1);
    CHECK(peak({expected.frames[0], expected.frames[8]}) > 1e-4);
    CHECK(run(made(surface, Form::One), 1) == expected);
    for (const int threads : {1, 4}) CHECK(run(made(surface, Form::Many), threads) == expected);
  }
}

TEST_CASE("so does one in a group, and one beside a force that follows a surface",
          "[simulation][custom][group][follow][threads]") {
  Asked asked;
  const auto made = [&](Form form) {
    Scene s = scene({sheet("s"), skin()}, forces(form, asked), 5);
    s.surfaces[1].name = "t";
    s.groups.push_back({.name = "g", .center = Value<3>{1, 0, 1}, .deformation_radius = 4});
    s.forces[0].group = s.forces[2].group = "g";
    s.forces.push_back(poke("rider", {0, 0, 0}, 300));
    s.forces.back().follow = "s";
    return s;
  };
  const Run expected = run(made(Form::BuiltIn), 1);
  CHECK(run(made(Form::One), 1) == expected);
  for (const int threads : {1, 4}) CHECK(run(made(Form::Many), threads) == expected);
}

TEST_CASE("a frame asks for many positions in few calls", "[simulation][custom]") {
  const auto calls_of_frame = [](Surface surface, Form form) {
    Asked asked;
    Kind wide = kinds()[0];
    wide.force.deformation_radius = 300;
    wide.force.force_radius = 200;
    wide.force.kind = of_many(wide.sampled, asked);
    if (form == Form::One) wide.force.magnitude = 0;
    auto simulation = Simulation::make(scene({std::move(surface)}, {wide.force}, 9)).value();
    REQUIRE(simulation.at(4));
    const int before = asked.calls;
    REQUIRE(simulation.at(5));
    return asked.calls - before;
  };
  for (const int count : {13, 101}) {
    CAPTURE(count);
    Surface grid = sheet("s", count);
    // The distances that select; both of a few nodes, of which one is pushed; both for the load.
    CHECK(calls_of_frame(grid, Form::Many) == 5);
    CHECK(calls_of_frame(grid, Form::One) == 3);  // nothing is pushed
    Surface triangles = skin();
    triangles.shape = square(count, 12, 0.2, true);
    // The distances that select, of the nodes in and around the region and of those inside; those
    // that the load is cut by; both for the load.
    CHECK(calls_of_frame(triangles, Form::Many) == 6);
    triangles.solver.region = SolvedRegion::All;
    CHECK(calls_of_frame(triangles, Form::Many) == 4);
  }
}

TEST_CASE("calls do not grow with the nodes that a force misses", "[simulation][custom]") {
  // Far from all nodes, exactly as far as its radius, or between the nodes of a face.
  for (const double height : {50.0, 0.5, 0.0}) {
    for (const int count : {7, 25}) {
      CAPTURE(height, count);
      Asked asked;
      Surface surface = skin();
      surface.shape = square(count, 12, 0, true);
      Force own = poke("f", {0, 0, 0});
      own.deformation_radius = 0.5;
      own.force_radius = 0.01;
      own.kind = of_many(PointForce{{0.7, height, 0.8}, {0, 1, 0}}, asked);
      auto simulation = Simulation::make(scene({surface}, {own}, 9)).value();
      REQUIRE(simulation.at(4));
      const int before = asked.calls;
      REQUIRE(simulation.at(5));
      CHECK(asked.calls - before < 600);
    }
  }
}

TEST_CASE("what a force of many positions leaves out is not finite", "[simulation][custom]") {
  const auto failure = [](CustomForce own) {
    Force force = poke("wind", {0, 0, 0});
    force.kind = std::move(own);
    auto simulation = Simulation::make(scene({sheet("s")}, {force})).value();
    const auto failed = simulation.at(3);
    REQUIRE_FALSE(failed);
    CHECK(failed.error().code == ErrorCode::NotFinite);
    CHECK_FALSE(preview_forces(simulation));
    return failed.error().message;
  };
  const auto up = [](Points, const ForceTime&, std::span<Vector3d> values) {
    std::ranges::fill(values, Vector3d(0, 1, 0));
  };
  CHECK_THAT(failure({.unit_force = [](Points, const ForceTime&, std::span<Vector3d>) {}}),
             contains_text("surface \"s\", frame 1: force \"wind\": its unit_force at ("));
  CHECK_THAT(
      failure({.distance = [](Points, const ForceTime&, std::span<double>) {}, .unit_force = up}),
      contains_text("force \"wind\": its distance at (-6, 0, -6) is nan, but must be"));
  CHECK_THAT(failure({.distance = [](Points, const ForceTime&,
                                     std::span<double> values) { values.back() = -1; },
                      .unit_force = up}),
             contains_text("force \"wind\": its distance at (-6, 0, -6) is nan, but must be"));
  CHECK_THAT(failure({.distance =
                          [](Points points, const ForceTime&, std::span<double> values) {
                            for (std::size_t k = 0; k < points.size(); ++k)
                              values[k] = 2 - std::abs(points[k].x());
                          },
                      .unit_force = up}),
             contains_text("force \"wind\": its distance at (-6, 0, -6) is -4, but must be"));
}

TEST_CASE("a function of positions that is made of an empty one is empty", "[forces][custom]") {
  using Distance = PositionFunction<double, const ForceTime&>;
  CHECK_FALSE(Distance());
  CHECK_FALSE(Distance(nullptr));
  CHECK_FALSE(Distance(Distance()));
  CHECK_FALSE(Distance(Distance::OfOne()));
  CHECK_FALSE(Distance(Distance::OfMany()));
  Distance function = [](const Vector3d& p, const ForceTime& time) { return p.x() + time.frame; };
  REQUIRE(function);
  const std::vector<Vector3d> points = {{1, 0, 0}, {2, 0, 0}};
  std::vector<double> values(2);
  function(points, {.frame = 10}, values);
  CHECK(values == std::vector<double>{11, 12});
  function = {};
  CHECK_FALSE(function);
}
