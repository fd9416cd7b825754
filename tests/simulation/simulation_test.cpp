#include "pliant/simulation/simulation.hpp"

#include <chrono>
#include <cmath>
#include <string>

#include "support/catch.hpp"
#include "support/scenes.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;
using Catch::Matchers::StartsWith;

namespace {

// A force that moves, grows and is constant for some frames.
Force travelling() {
  Force force = poke("travelling", {});
  force.kind = PointChannels{.center = vector_curve({{1, {-4, 0, -2}}, {12, {4, 0, 3}}}),
                             .direction = Value<3>{0.3, 1, 0}};
  force.magnitude = curve({{1, 0}, {6, 8000}, {12, 2000}});
  force.enabled = switch_at({{1, true}, {7, false}, {9, true}});
  return force;
}

}  // namespace

TEST_CASE("a sheet and its PLY file move alike, bit for bit", "[simulation]") {
  const ScratchFolder folder;
  Surface from_grid = sheet("s");
  const Mesh mesh = make_mesh(std::get<GridSheet>(from_grid.shape));
  const AnimationPlan plan{.file = folder.file("#.ply"),
                           .surfaces = {{"s", &mesh, mesh.positions}},
                           .first_frame = 1,
                           .last_frame = 1};
  REQUIRE(make_writer(plan).value()->write(1, std::vector<SurfacePose>{{mesh.positions}}));
  Surface from_file = from_grid;
  from_file.shape = MeshFile{folder.file("1.ply")};
  const std::vector<Force> forces = {poke("p", {1.5, 0, -2})};
  const auto expected = baked(scene({from_grid}, forces), "s");
  CHECK(baked(scene({from_file}, forces), "s") == expected);
  CHECK(largest_difference(expected.front(), expected.back()) > 0.1);
}

TEST_CASE("the first motion shows one frame after the start", "[simulation]") {
  Scene s = scene({sheet("s")}, {poke("f", {0, 0, 0})});
  s.surfaces[0].solver.start_frame = GENERATE(-5, 1, 4, 11);
  const int start = std::max(1, *s.surfaces[0].solver.start_frame);
  const auto frames = baked(s, "s");
  for (int frame = 1; frame <= 12; ++frame) {
    CHECK((frames[frame - 1] == frames[0]) == (frame <= start));
  }
}

TEST_CASE("a surface whose start lies beyond the end stays at rest", "[simulation]") {
  Scene s = scene({sheet("s")}, {poke("f", {0, 0, 0})});
  s.surfaces[0].solver.start_frame = 13;
  CHECK(peak(baked(s, "s")) == 0);
}

TEST_CASE("a disabled surface stays at rest", "[simulation]") {
  Scene s = scene({sheet("s"), sheet("off")}, {poke("f", {0, 0, 0})});
  s.surfaces[1].enabled = false;
  CHECK(peak(baked(s, "s")) > 0);
  CHECK(peak(baked(s, "off")) == 0);
}

TEST_CASE("the same scene gives the same bits twice", "[simulation]") {
  const Scene s = scene({sheet("s")}, {travelling(), poke("f", {1, 0, 2})});
  CHECK(baked(s, "s") == baked(s, "s"));
}

TEST_CASE("frames have the same bits in any order, whatever is kept", "[simulation]") {
  const Scene s = scene({sheet("s"), sheet("t", 9)}, {travelling()});
  const auto expected_s = baked(s, "s"), expected_t = baked(s, "t");
  const std::size_t kept = GENERATE(std::size_t{0}, std::size_t{60'000}, std::size_t{1} << 28);
  auto simulation = Simulation::make(s, {.checkpoint_bytes = kept}).value();
  for (const int frame : {12, 1, 7, 6, 8, 12, 2, 2, 11, 1, 12}) {
    const Frame at = simulation.at(frame).value();
    CHECK(at.number() == frame);
    CHECK(at.surface("s").positions() == expected_s[frame - 1]);
    CHECK(at.surface("t").positions() == expected_t[frame - 1]);
  }
}

TEST_CASE("going back to the start resets, also what velocity was carried", "[simulation]") {
  const Scene s = scene({sheet("s")}, {poke("f", {0, 0, 0})});
  auto simulation = Simulation::make(s, {.checkpoint_bytes = 0}).value();
  const Field second = simulation.at(2)->surface("s").positions();
  REQUIRE(simulation.at(12));
  CHECK(simulation.at(1)->surface("s").peak_displacement() == 0);
  CHECK(simulation.at(2)->surface("s").positions() == second);
}

TEST_CASE("surfaces of one scene do not know each other", "[simulation]") {
  Surface second = sheet("b", 9);
  second.material.density = 10.0;
  second.solver.stepping = Stepping::Overshoot;
  const std::vector<Force> forces{travelling()};
  const Scene both = scene({sheet("a"), second}, forces);
  CHECK(baked(both, "a") == baked(scene({sheet("a")}, forces), "a"));
  CHECK(baked(both, "b") == baked(scene({second}, forces), "b"));
}

TEST_CASE("a rigid motion of surface and forces together moves the result", "[simulation]") {
  const Value<3> rotate{30, -50, 110}, translate{5, -7, 2};
  const Transform move = make_transform({5, -7, 2}, {30, -50, 110}, {1, 1, 1}, RotateOrder::Xyz);
  const auto moved = [&](const Value<3>& p) {
    const Vector3d q = move.linear * Vector3d(p[0], p[1], p[2]) + move.translation;
    return Value<3>{q[0], q[1], q[2]};
  };
  const auto turned = [&](const Value<3>& d) {
    const Vector3d q = move.linear * Vector3d(d[0], d[1], d[2]);
    return Value<3>{q[0], q[1], q[2]};
  };
  Force point = poke("point", {-2.3, 0, 1.2});
  std::get<PointChannels>(point.kind).direction = Value<3>{0.4, 1, -0.2};
  Force radial = poke("radial", {});
  radial.kind = RadialChannels{.center = Value<3>{2.2, -1.3, -0.4}};
  radial.falloff = Falloff::Smooth;
  Force line = poke("line", {}, -3000);
  line.kind = LineChannels{.from = Value<3>{-4.1, 0.3, -3}, .to = Value<3>{3.3, 0.2, -2.1}};
  Scene original = scene({sheet("s")}, {point, radial, line});
  original.surfaces[0].solver.combine = GENERATE(Combine::Box, Combine::Islands, Combine::Union);
  original.surfaces[0].solver.release = GENERATE(Release::Freeze, Release::Recover);
  original.forces[0].enabled = switch_at({{1, true}, {7, false}});

  Scene image = original;
  image.surfaces[0].transform.translate = translate;
  image.surfaces[0].transform.rotate = rotate;
  std::get<PointChannels>(image.forces[0].kind) = {.center = moved({-2.3, 0, 1.2}),
                                                   .direction = turned({0.4, 1, -0.2})};
  std::get<RadialChannels>(image.forces[1].kind) = {.center = moved({2.2, -1.3, -0.4})};
  std::get<LineChannels>(image.forces[2].kind) = {.from = moved({-4.1, 0.3, -3}),
                                                  .to = moved({3.3, 0.2, -2.1})};
  const auto frames = baked(original, "s"), image_frames = baked(image, "s");
  REQUIRE(peak(frames) > 0.1);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    CHECK(largest_difference(to_world(move, frames[k]), image_frames[k]) < 1e-11 * peak(frames));
  }
}

TEST_CASE("forces that ride on a moving surface act as if nothing moved", "[simulation]") {
  // A key at every frame moves the force with the surface's transform.
  Scene original = scene({sheet("s", 21)}, {poke("f", {-2.3, 0, 1.2}), poke("g", {4, 0, -3})});
  original.surfaces[0].solver.combine = Combine::Islands;
  original.surfaces[0].solver.release = Release::Recover;
  original.forces[1].enabled = switch_at({{1, true}, {5, false}});
  Scene moving = original;
  std::vector<std::pair<double, Value<3>>> translate, rotate, center[2], direction;
  for (int frame = 1; frame <= 12; ++frame) {
    const Vector3d degrees(3.0 * frame, -11.0 * frame, 40), place(0.7 * frame, 5, -0.2 * frame);
    const Transform move = make_transform(place, degrees, {1, 1, 1}, RotateOrder::Xyz);
    const auto key = [&](const Vector3d& p) {
      return std::pair{double(frame), Value<3>{p[0], p[1], p[2]}};
    };
    translate.push_back(key(place));
    rotate.push_back(key(degrees));
    direction.push_back(key(move.linear * Vector3d(0, 1, 0)));
    center[0].push_back(key(move.linear * Vector3d(-2.3, 0, 1.2) + move.translation));
    center[1].push_back(key(move.linear * Vector3d(4, 0, -3) + move.translation));
  }
  moving.surfaces[0].transform.translate = vector_curve(translate);
  moving.surfaces[0].transform.rotate = vector_curve(rotate);
  for (int k = 0; k < 2; ++k) {
    moving.forces[k].kind =
        PointChannels{.center = vector_curve(center[k]), .direction = vector_curve(direction)};
  }
  auto still = Simulation::make(original).value(), carried = Simulation::make(moving).value();
  for (int frame = 1; frame <= 12; ++frame) {
    const Frame a = still.at(frame).value(), b = carried.at(frame).value();
    CHECK(largest_difference(a.surface("s").object_positions(), b.surface("s").object_positions()) <
          1e-11);
  }
  CHECK(still.at(12)->surface("s").peak_displacement() > 0.1);
}

TEST_CASE("a scaled surface feels world-space radii and forces", "[simulation]") {
  // Twice as large in space, half as large in the transform: the same world.
  Surface small = sheet("s");
  std::get<GridSheet>(small.shape).width = std::get<GridSheet>(small.shape).depth = 6;
  small.transform.scale = Value<3>{2, 2, 2};
  const std::vector<Force> forces{travelling()};
  const auto frames = baked(scene({sheet("s")}, forces), "s");
  const auto scaled = baked(scene({small}, forces), "s");
  for (std::size_t k = 0; k < frames.size(); ++k) CHECK(frames[k] == scaled[k]);  // powers of 2
}

TEST_CASE("output is the mesh under the frame's own transform", "[simulation]") {
  Scene s = scene({sheet("s")}, {});
  s.surfaces[0].transform.translate = vector_curve({{1, {0, 0, 0}}, {12, {0, 11, 0}}});
  auto simulation = Simulation::make(s).value();
  const Field rest = simulation.at(1)->surface("s").positions();
  const Field last = simulation.at(12)->surface("s").positions();
  CHECK((last - rest).col(1).isConstant(11));
  CHECK(simulation.at(12)->surface("s").object_positions() == rest);
  CHECK(simulation.at(12)->surface("s").peak_displacement() == 0);
}

TEST_CASE("a frame rate may be a fraction", "[simulation]") {
  Scene s = scene({sheet("s")}, {poke("f", {0, 0, 0})});
  const auto at_24 = baked(s, "s");
  s.fps = 24000.0 / 1001;
  const auto at_23_976 = baked(s, "s");
  CHECK(at_24[1] != at_23_976[1]);
  CHECK(largest_difference(at_24[11], at_23_976[11]) < 0.01 * peak(at_24));
}

TEST_CASE("a small scene in other units is the same scene", "[simulation]") {
  // Lengths times k: positions, radii and magnitudes scale, (u,v) do not.
  const double k = GENERATE(1e-3, 1e3);
  Scene s = scene({sheet("s")}, {poke("f", {0.3, 0, 0.2})});
  const auto frames = baked(s, "s");
  auto& shape = std::get<GridSheet>(s.surfaces[0].shape);
  shape.width *= k;
  shape.depth *= k;
  s.forces[0] = poke("f", {0.3 * k, 0, 0.2 * k}, 5000 * k);
  s.forces[0].deformation_radius = 4.5 * k;
  s.forces[0].force_radius = 2.5 * k;
  const auto scaled = baked(s, "s");
  for (std::size_t f = 0; f < frames.size(); ++f) {
    CHECK(largest_difference(k * frames[f], scaled[f]) < 1e-12 * k * peak(frames));
  }
}

TEST_CASE("every problem of a scene is found before the first solve", "[simulation]") {
  Scene s = scene({sheet("s"), sheet("t")}, {poke("f", {0, 0, 0})});
  s.surfaces[0].material.density = -1.0;
  s.surfaces[1].shape = Mesh{};
  s.forces[0].force_radius = -1.0;
  const auto simulation = Simulation::make(s);
  REQUIRE_FALSE(simulation);
  CHECK(to_lines(simulation.error()).size() == 3);
  CHECK_THAT(Simulation::make(scene({}, {})).error().message, Contains("no surface"));
}

TEST_CASE("a frame outside the range and a run that fails are errors, and the next call is sound",
          "[simulation]") {
  Scene s = scene({sheet("a"), sheet("s")}, {poke("f", {0, 0, 0})});
  auto& material = s.surfaces[1].material;
  material.density = material.damping = 0.0;
  material.b = material.d = 1e-170;  // so soft that the load below overflows
  material.c = 2e-170;
  s.forces[0].targets = {"s"};
  CurveKeys<1> jump;
  jump.keys = {{.frame = 1, .value = {1e-169}}, {.frame = 8, .value = {1e149}}};
  jump.keys[0].next.kind = Interpolation::Kind::Step;
  s.forces[0].magnitude = Curve<1>::make(jump).value();
  auto simulation = Simulation::make(s).value();
  CHECK_THAT(simulation.at(0).error().message,
             Contains("frame 0 is outside the scene's frames 1 to 12"));
  CHECK(simulation.at(13).error().code == ErrorCode::InvalidInput);
  const Field fifth = simulation.at(5)->surface("s").positions();
  const auto failed = simulation.at(12);
  REQUIRE_FALSE(failed);
  CHECK(failed.error().code == ErrorCode::NotFinite);
  CHECK_THAT(failed.error().message, Contains("surface \"s\", frame 8"));
  CHECK(simulation.at(5)->surface("s").positions() == fifth);
}

TEST_CASE("a position beyond double in world space is an error in whatever order", "[simulation]") {
  // Not finite only at frame 4, where no node can be selected. Later frames fail too, although they
  // are finite.
  Scene s = scene({sheet("s")}, {poke("f", {0, 0, 0})});
  std::get<GridSheet>(s.surfaces[0].shape).width = 1e200;
  CurveKeys<3> jump;
  jump.keys = {{.frame = 1, .value = {1, 1, 1}},
               {.frame = 4, .value = {1e150, 1, 1}},
               {.frame = 5, .value = {1, 1, 1}}};
  for (auto& key : jump.keys) key.next.kind = Interpolation::Kind::Step;
  s.surfaces[0].transform.scale = Curve<3>::make(jump).value();
  auto simulation = Simulation::make(s).value();
  const auto later = simulation.at(9);
  REQUIRE_FALSE(later);
  CHECK_THAT(later.error().message, Contains("frame 4: a position in world space"));
  CHECK(simulation.at(4).error().message == later.error().message);
  CHECK(simulation.at(3));
}

TEST_CASE("under a scale that is not uniform a force enters through its inverse", "[simulation]") {
  // Static, in object space: the world's load divided by the scale of each axis.
  Scene s = scene({sheet("s")}, {}, 2);
  s.surfaces[0].material.density = s.surfaces[0].material.damping = 0.0;
  const auto peak_along = [&](const Value<3>& scale, const Value<3>& direction) {
    s.surfaces[0].transform.scale = scale;
    Force force = poke("f", {0, 0, 0}, 1000);
    force.kind = PointChannels{.center = Value<3>{0, 0, 0}, .direction = direction};
    force.deformation_radius = force.force_radius = 1000.0;  // the whole sheet, whatever the scale
    s.forces = {force};
    auto simulation = Simulation::make(s).value();
    const Field object = simulation.at(2)->surface("s").object_positions();
    return Eigen::RowVector3d((object - simulation.at(1)->surface("s").object_positions())
                                  .cwiseAbs()
                                  .colwise()
                                  .maxCoeff());
  };
  const double plain = peak_along({1, 1, 1}, {0, 1, 0})[1];
  const Eigen::RowVector3d scaled = peak_along({2, 4, -0.5}, {1, 1, 1});
  const double share = plain / std::sqrt(3.0);
  CHECK((scaled - Eigen::RowVector3d(share / 2, share / 4, share / 0.5)).norm() < 1e-12 * plain);
}

TEST_CASE("a position beyond double in world space is an error", "[simulation]") {
  Scene s = scene({sheet("s")}, {});
  std::get<GridSheet>(s.surfaces[0].shape).width = 1e200;
  s.surfaces[0].transform.scale = Value<3>{1e200, 1, 1};
  const auto frame = Simulation::make(s).value().at(1);
  REQUIRE_FALSE(frame);
  CHECK_THAT(frame.error().message, Contains("surface \"s\", frame 1: a position in world space"));
}

TEST_CASE("a run stops when asked to, and goes on afterwards", "[simulation]") {
  const Scene s = scene({sheet("s")}, {poke("f", {0, 0, 0})});
  int steps_left = 1000;
  auto simulation = Simulation::make(s, {.should_stop = [&] { return steps_left-- == 0; }}).value();
  REQUIRE(simulation.at(3));
  steps_left = 3;  // the step from frame 3 on asks more often
  const auto stopped = simulation.at(12);
  REQUIRE_FALSE(stopped);
  CHECK(stopped.error().code == ErrorCode::Interrupted);
  CHECK_THAT(stopped.error().message, Contains("frame 3"));
  CHECK(simulation.at(12)->surface("s").positions() == baked(s, "s").back());
}

TEST_CASE("a region too small to solve is told once, with its frames", "[simulation]") {
  Scene s = scene({sheet("s")}, {poke("tiny", {0, 0, 0})});
  s.forces[0].deformation_radius = 0.5;
  s.forces[0].force_radius = 0.5;
  s.forces[0].enabled = switch_at({{1, true}, {4, false}, {6, true}});
  auto simulation = Simulation::make(s).value();
  REQUIRE(simulation.at(12));
  REQUIRE(simulation.at(1));
  REQUIRE(simulation.at(12));
  REQUIRE(simulation.warnings().size() == 1);
  CHECK_THAT(simulation.warnings()[0].message(),
             Contains("\"tiny\"") && Contains("frames 1-3, 6-11"));
}

TEST_CASE("the number of threads changes no bit", "[simulation][threads]") {
  // Several surfaces are solved in parallel, a single one in parts.
  const std::vector<Force> forces{poke("f", {0.3, 0, 0.2}), poke("g", {-2, 0, 1}, -3000)};
  Scene s = GENERATE_COPY(
      scene({sheet("a", 21), sheet("b", 13), sheet("c", 17), sheet("d", 9)}, forces, 8),
      scene({sheet("a", 121), sheet("b", 13)}, forces, 8), scene({sheet("a", 121)}, forces, 8));
  if (s.surfaces.size() > 1) s.surfaces[1].enabled = false;
  s.forces[1].deformation_radius = 100;  // the whole sheet: large enough to use several threads
  const auto all_frames = [&](int threads) {
    auto simulation = Simulation::make(s, {.threads = threads}).value();
    std::vector<Field> positions;
    for (const int frame : simulation.frames()) {
      const Frame at_frame = simulation.at(frame).value();
      for (const auto& surface : at_frame.surfaces()) {
        positions.push_back(surface.positions());
      }
    }
    return positions;
  };
  const auto alone = all_frames(1);
  for (const int threads : {2, 3, 8}) CHECK((all_frames(threads) == alone));
}

TEST_CASE("the width of the solver's vectors changes no bit", "[simulation]") {
  const Scene s = scene({sheet("a", 41)}, {poke("f", {0.3, 0, 0.2}), poke("g", {-2, 0, 1}, -3000)});
  const auto last_frame = [&](int most_lanes) {
    auto simulation = Simulation::make(s, {.most_lanes = most_lanes}).value();
    return simulation.at(12).value().surface("a").positions();
  };
  const Field widest = last_frame(widest_lanes);
  for (const int lanes : {1, 2, 4, 8}) CHECK((last_frame(lanes) == widest));
}

TEST_CASE("what a run takes is known before it is allocated", "[simulation][memory]") {
  Scene s = scene({sheet("small"), sheet("large", 10'000)}, {poke("f", {0, 0, 0})});
  s.origin = origin_of("scene.xml", {{"large", 4}, {"small", 3}});
  const auto too_large = Simulation::make(s, {.max_memory = 1'000'000'000});
  REQUIRE_FALSE(too_large);
  CHECK(too_large.error().code == ErrorCode::OutOfMemory);
  CHECK(too_large.error().line == 4);
  CHECK_THAT(too_large.error().message,
             StartsWith("surface \"large\" needs ") && EndsWith("of the 1 GB allowed"));
  CHECK(Simulation::check(s));  // apart from its memory it is valid
  CHECK(Simulation::check(s, {.max_memory = 1'000'000'000}).error().message ==
        too_large.error().message);

  // The surface fits, and so does the factor of a small region; that of a large one does not.
  s = scene({sheet("s", 151)}, {poke("f", {0, 0, 0})}, 3);
  s.forces[0].deformation_radius = curve({{1, 4.5}, {2, 100}});
  const SolverChoice choice = GENERATE(SolverChoice::Auto, SolverChoice::Eigen);
  // The surface alone needs nearly 20 MB; a plate in sine space needs less than a factor.
  SimulationOptions options{.max_memory = choice == SolverChoice::Auto ? 21'000'000u : 30'000'000u,
                            .solver = choice};
  auto simulation = Simulation::make(s, options).value();
  CHECK(simulation.at(2));
  const auto refused = simulation.at(3);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::OutOfMemory);
  CHECK_THAT(
      refused.error().message,
      StartsWith(choice == SolverChoice::Auto
                     ? "surface \"s\", frame 2: the solve of the plate of 22201 unknowns needs "
                     : "surface \"s\", frame 2: the factor of the plate's matrix of 22201 "
                       "unknowns needs "));
  CHECK(simulation.at(2));  // the simulation is still usable
  options.max_memory += 30'000'000;
  CHECK(Simulation::make(s, options).value().at(3));
}

TEST_CASE("what a run has reserved is what it needs", "[simulation][memory]") {
  const Scene s = scene({sheet("s", 61)}, {poke("f", {0, 0, 0})}, 3);
  SimulationOptions options{.solver = GENERATE(SolverChoice::Auto, SolverChoice::Eigen)};
  auto simulation = Simulation::make(s, options).value();
  const std::size_t at_first = simulation.reserved_memory();
  CHECK(at_first >= simulation.surface_memory());
  REQUIRE(simulation.at(3));
  const std::size_t needed = simulation.reserved_memory();
  CHECK(needed > at_first);  // by its solver
  options.max_memory = needed;
  CHECK(Simulation::make(s, options).value().at(3));
  options.max_memory = needed - 1;
  CHECK(Simulation::make(s, options).value().at(3).error().code == ErrorCode::OutOfMemory);
}

TEST_CASE("a scene is checked without being run", "[simulation][check]") {
  CHECK(Simulation::check(scene({}, {poke("f", {0, 0, 0})})));  // no surface: nothing to refuse
  Scene s = scene({sheet("a"), sheet("b")}, {poke("f", {0, 0, 0})});
  CHECK(Simulation::check(s));
  s.surfaces[0].shape = MeshFile{"none.obj", ""};
  s.surfaces[1].material.density = -1;
  const auto refused = Simulation::check(s);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().others.size() == 1);  // both
}

TEST_CASE("a simulation takes the place of another", "[simulation][threads]") {
  const Scene first = scene({sheet("s")}, {poke("f", {0, 0, 0})});
  const Scene second = scene({sheet("t", 9), sheet("u", 11)}, {poke("f", {0, 0, 0})});
  auto simulation = Simulation::make(first, {.threads = 2}).value();
  auto other = Simulation::make(second, {.threads = 3}).value();
  REQUIRE((simulation.at(5) && other.at(3)));
  const Field expected = other.at(7).value().surface("u").positions();
  simulation = std::move(other);
  CHECK(simulation.at(7).value().surface("u").positions() == expected);
  simulation = Simulation::make(first).value();
  CHECK(simulation.at(12).value().surface("s").positions() == baked(first, "s").back());
}

TEST_CASE("make stops when asked to", "[simulation]") {
  const Scene s = scene({sheet("s")}, {poke("f", {0, 0, 0})});
  const auto stopped = Simulation::make(s, {.should_stop = [] { return true; }});
  REQUIRE_FALSE(stopped);
  CHECK(stopped.error().code == ErrorCode::Interrupted);
  CHECK(Simulation::check(s, {.should_stop = [] { return true; }}).error().code ==
        ErrorCode::Interrupted);
}

TEST_CASE("errors come in the order of files and lines, each once", "[simulation][check]") {
  Scene s = scene({sheet("a"), sheet("b"), sheet("c")}, {poke("f", {0, 0, 0})});
  s.surfaces[0].shape = MeshFile{"none.obj", ""};
  s.surfaces[1].material.density = -1;
  s.forces[0].force_radius = -1;
  s.origin = origin_of("s.xml", {{"a", 2}, {"a.file", 3}, {"b", 5}, {"f", 4}});
  const auto refused = Simulation::check(s);
  REQUIRE_FALSE(refused);
  std::vector<int> lines{refused.error().line};
  for (const Error& other : refused.error().others) lines.push_back(other.line);
  CHECK(lines == std::vector<int>{3, 4, 5});
}

TEST_CASE("a frame in the memory of another is the same frame", "[simulation]") {
  const std::vector<Force> forces{poke("f", {0.3, 0, 0.2}), poke("g", {-2, 0, 1}, -3000)};
  const Scene s = scene({sheet("a", 21), sheet("b", 13)}, forces, 8);
  auto simulation = Simulation::make(s).value(), other = Simulation::make(s).value();
  Frame frame;
  Field positions = Field::Ones(5, 3);
  for (const int number : {1, 2, 5, 8, 3, 3, 7}) {
    frame = simulation.at(number, std::move(frame)).value();
    const Frame fresh = other.at(number).value();
    CHECK(frame.number() == number);
    REQUIRE(frame.surfaces().size() == 2);
    for (const std::string name : {"a", "b"}) {
      positions = frame.surface(name).positions(std::move(positions));
      CHECK(positions == fresh.surface(name).positions());
      CHECK(frame.surface(name).peak_displacement() == fresh.surface(name).peak_displacement());
    }
  }
}

TEST_CASE("a profile tells where the time of frames goes, when asked for",
          "[simulation][profile]") {
  const Scene s = scene({sheet("a", 41), sheet("b", 21)}, {poke("f", {0.3, 0, 0.2})}, 8);
  for (const auto choice : {SolverChoice::Spectral, SolverChoice::Eigen}) {
    const auto begin = std::chrono::steady_clock::now();
    auto simulation = Simulation::make(s, {.solver = choice, .profile = true}).value();
    REQUIRE(simulation.profile().total() == 0);
    REQUIRE(simulation.at(8));
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
    const Profile profile = simulation.profile();
    for (std::size_t k = 0; k < stage_count; ++k) {
      const auto stage = static_cast<Stage>(k);
      CAPTURE(name_of(stage));
      CHECK((profile[stage] > 0) == (stage != Stage::Writing));  // a simulation does not write
    }
    CHECK(profile.total() < elapsed.count());
  }
  auto silent = Simulation::make(s).value();
  REQUIRE(silent.at(8));
  CHECK(silent.profile().total() == 0);
}

TEST_CASE("a state is that of the frame that was reported last", "[simulation]") {
  const Scene s = scene({sheet("s"), sheet("t")}, {travelling()});
  auto simulation = Simulation::make(s).value();
  CHECK(simulation.state(1).positions == simulation.rest_shapes()[1].rest);
  CHECK(simulation.state(1).velocities.isZero(0));
  for (const int frame : {7, 3, 12}) {
    REQUIRE(simulation.report(frame));
    const BodyState state = simulation.state(0);
    const auto positions = simulation.at(frame).value().surface("s").object_positions();
    CHECK(simulation.rest_shapes()[0].to_vertices(state.positions) == positions);
    CHECK_FALSE(state.velocities.isZero(0));
  }
}
