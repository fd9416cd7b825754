#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "contact/solid_meshes.hpp"
#include "pliant/contact/collider.hpp"
#include "pliant/states/state_store.hpp"
#include "support/caches.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/moving_scene.hpp"
#include "support/scenes.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;

// Colliders. docs/model.md, "Contact".

namespace {

Collider collider(const std::string& name, TransformChannels transform) {
  Collider made;
  made.name = name;
  made.transform = std::move(transform);
  return made;
}

Collider ball_on_keys(double radius, std::vector<std::pair<double, Value<3>>> keys) {
  Collider made = collider("ball", {.translate = vector_curve(std::move(keys))});
  made.shape = SphereChannels{.radius = radius};
  return made;
}

Collider floor_at(double height) {
  Collider made = collider("floor", {.translate = Value<3>{0, height, 0}});
  made.shape = PlaneChannels{};
  return made;
}

// A sheet from -6 to 6 that is solved as a whole.
Surface wide_mat(const std::string& name = "s") {
  Surface surface = light(sheet(name));
  surface.material.density = 0.002;
  surface.material.damping = 0.001;
  return surface;
}

Surface wide_skin() {
  Surface surface = light_skin(square(12, 12, 0.2));
  surface.material.density = 0.002;
  surface.material.damping = 0.001;
  return surface;
}

Force weight_of(double magnitude) {
  Force force;
  force.name = "gravity";
  force.magnitude = magnitude;
  force.deformation_radius = force.force_radius = 100;
  force.kind = UniformChannels{.direction = Value<3>{0, -1, 0}};
  return force;
}

Scene met_scene(Surface surface, std::vector<Collider> colliders, std::vector<Force> forces = {}) {
  Scene made = scene({std::move(surface)}, std::move(forces));
  made.colliders = std::move(colliders);
  return made;
}

SampledCollider standing(const Collider& of, double frame) {
  ColliderPose pose{SphereSolid{1}, of.transform.placement_at(frame), of.offset.at(frame)[0]};
  if (const auto* const sphere = std::get_if<SphereChannels>(&of.shape))
    pose.shape = SphereSolid{sphere->radius.at(frame)[0]};
  if (const auto* const capsule = std::get_if<CapsuleChannels>(&of.shape))
    pose.shape = CapsuleSolid{capsule->radius.at(frame)[0], capsule->length.at(frame)[0]};
  if (const auto* const box = std::get_if<BoxChannels>(&of.shape)) {
    const Value<3> size = box->size.at(frame);
    pose.shape = BoxSolid{{size[0], size[1], size[2]}, box->round.at(frame)[0]};
  }
  if (std::holds_alternative<PlaneChannels>(of.shape)) pose.shape = PlaneSolid{};
  return {pose, pose, 0};
}

// How deep the deepest of the vertices is in a collider that is where it is at a frame.
double depth_in(const Collider& of, double frame, const Field& positions) {
  const PlacedCollider one = placed(standing(of, frame), 0);
  double deepest = -1e300;
  for (Eigen::Index k = 0; k < positions.rows(); ++k) {
    const Vector3d p = positions.row(k).transpose();
    deepest = std::max(deepest, -nearness(one.kept, one.to_frame(p)).distance);
  }
  return deepest;
}

std::vector<Field> frames_met(const Scene& scene) { return baked(scene, "s"); }

// Solids that dip into the middle of the mat, and leave it again.
std::vector<Collider> dippers() {
  const TransformChannels dip{
      .translate = vector_curve({{1, {0.2, 3, -0.3}}, {5, {0.6, -0.8, 0.2}}, {12, {-1, 4, 0}}}),
      .rotate = vector_curve({{1, {0, 0, 10}}, {12, {40, 90, -20}}})};
  std::vector<Collider> all(4, collider("dip", dip));
  all[0].shape = SphereChannels{.radius = 1.4};
  all[1].shape = CapsuleChannels{.radius = 0.9, .length = curve({{1, 1}, {8, 3}})};
  all[2].shape = BoxChannels{.size = Value<3>{3, 1, 2}, .round = 0.2};
  all[3].shape = BoxChannels{.size = Value<3>{3, 1, 2}};
  for (Collider& one : all) one.offset = 0.05;
  return all;
}

}  // namespace

TEST_CASE("no node enters a collider, and what it meets moves", "[simulation][contact]") {
  for (const Surface& surface : {wide_mat(), wide_skin()}) {
    for (const Collider& dipper : dippers()) {
      const std::vector<Field> frames = frames_met(met_scene(surface, {dipper}));
      for (std::size_t k = 0; k < frames.size(); ++k) {
        CAPTURE(k, shape_of(dipper), surface.reading.uv == UvReading::Surface);
        CHECK(depth_in(dipper, double(k) + 1, frames[k]) < 1e-8);
      }
      CHECK(peak(frames) > 0.1);
    }
  }
}

TEST_CASE("a collider that stays away leaves all bits as they are", "[simulation][contact]") {
  for (const Integrator integrator : {Integrator::BackwardEuler, Integrator::Newmark}) {
    for (Surface surface : {wide_mat(), wide_skin()}) {
      surface.solver.integrator = integrator;
      const Force push = poke("push", {0.3, 0, 0.2}, 3);
      const std::vector<Field> alone = frames_met(met_scene(surface, {}, {push}));
      Collider disabled = ball_on_keys(2, {{1, {0, 0, 0}}});
      disabled.name = "off";
      disabled.enabled = false;
      const std::vector<Field> beside = frames_met(met_scene(
          surface, {ball_on_keys(1, {{1, {0, 9, 0}}, {12, {3, -8, 90}}}), disabled}, {push}));
      REQUIRE(peak(alone) > 0);
      for (std::size_t k = 0; k < alone.size(); ++k) CHECK(alone[k] == beside[k]);
    }
  }
}

TEST_CASE("a surface turned, moved or scaled with its colliders does the same",
          "[simulation][contact]") {
  const double size = 2.5;
  const Transform turn = make_transform({3, -20, 7}, {30, -50, 80}, {1, 1, 1}, RotateOrder::Xyz);
  for (Surface surface : {wide_mat(), wide_skin()}) {
    const Force weight = weight_of(0.5);
    const Collider one =
        ball_on_keys(1.2, {{1, {0.3, 2, 0.1}}, {6, {0, -0.5, 0.4}}, {12, {0, 3, 0}}});
    const std::vector<Field> expected =
        frames_met(met_scene(surface, {one, floor_at(-0.6)}, {weight}));
    REQUIRE(peak(expected) > 0.5);
    surface.transform = {.translate = Value<3>{3, -20, 7},
                         .rotate = Value<3>{30, -50, 80},
                         .scale = Value<3>{size, size, size}};
    std::vector<std::pair<double, Value<3>>> keys;
    for (int frame = 1; frame <= 13; ++frame) {
      const Value<3> at = one.transform.translate.at(frame);
      const Vector3d p = to_world(turn, Vector3d(size * Vector3d(at[0], at[1], at[2])));
      keys.push_back({double(frame), {p[0], p[1], p[2]}});
    }
    // Straight from frame to frame, as a solve takes the way.
    const Collider moved = ball_on_keys(1.2 * size, keys);
    const Vector3d foot = to_world(turn, Vector3d(0, -0.6 * size, 0));
    Collider ground = floor_at(0);
    ground.transform = {.translate = Value<3>{foot[0], foot[1], foot[2]},
                        .rotate = Value<3>{30, -50, 80}};
    Force pull = weight;
    pull.magnitude = 0.5 * size;
    pull.deformation_radius = pull.force_radius = 1000;
    const Vector3d down = turn.linear * Vector3d(0, -1, 0);
    pull.kind = UniformChannels{.direction = Value<3>{down[0], down[1], down[2]}};
    const std::vector<Field> found = frames_met(met_scene(surface, {moved, ground}, {pull}));
    for (std::size_t k = 0; k < found.size(); ++k) {
      const Field back = to_world(turn, Field(size * expected[k]));
      CHECK(largest_difference(found[k], back) < 1e-8 * size * peak(expected));
    }
  }
}

TEST_CASE("a surface that moves with its colliders does what one that stands does",
          "[simulation][contact]") {
  const TransformChannels motion{.translate = vector_curve({{1, {0, 0, 0}}, {13, {30, -5, 12}}})};
  const Collider one = ball_on_keys(1.2, {{1, {0.3, 2, 0.1}}, {13, {0, -2, 0.4}}});
  for (Surface surface : {wide_mat(), wide_skin()}) {
    const std::vector<Field> expected = frames_met(met_scene(surface, {one}));
    REQUIRE(peak(expected) > 0.5);
    surface.transform = motion;
    Collider carried = ball_on_keys(1.2, {{1, {0.3, 2, 0.1}}, {13, {30, -7, 12.4}}});
    carried.transform.translate = vector_curve({{1, {0.3, 2, 0.1}}, {13, {30, -7, 12.4}}});
    const std::vector<Field> found = frames_met(met_scene(surface, {carried}));
    for (std::size_t k = 0; k < found.size(); ++k) {
      const Value<3> at = motion.translate.at(double(k) + 1);
      Field back = found[k];
      back.rowwise() -= Eigen::RowVector3d(at[0], at[1], at[2]);
      CHECK(largest_difference(back, expected[k]) < 1e-8 * peak(expected));
    }
  }
}

TEST_CASE("a single node does what can be computed by hand", "[simulation][contact]") {
  Surface surface = light(sheet("s", 3));
  surface.material.density = 0.5;
  surface.material.damping = 0.1;
  surface.solver.dt = 1.0;  // one step a frame
  const double load = 90, depth = 0.02;
  const std::vector<Field> frames =
      frames_met(met_scene(surface, {floor_at(-depth)}, {weight_of(load)}));
  // A node between clamped edges with spacings of 1: 20 + 4 of the ghosts, b = d = 1, c = 2.
  const double dt = 1.0 / 24, shift = 0.5 / (dt * dt) + 0.1 / dt, stiffness = 20 + 4;
  double w = 0, v = 0;
  bool touched = false;
  for (std::size_t k = 1; k < frames.size(); ++k) {
    const double free = (-load + shift * w + 0.5 / dt * v) / (shift + stiffness);
    const double next = std::max(-depth, free);
    touched = touched || next > free;
    v = (next - w) / dt;
    w = next;
    CHECK_THAT(frames[k](4, 1), WithinAbs(w, 1e-12));
  }
  CHECK(touched);
}

TEST_CASE("a collider selects what comes near it, as a force does", "[simulation][contact]") {
  Surface surface = sheet("s");
  Collider one = ball_on_keys(1, {{1, {0, 1.5, 0}}, {3, {0, 0.5, 0}}, {12, {0, -0.5, 0}}});
  one.deformation_radius = 2.5;
  const std::vector<Field> frames = frames_met(met_scene(surface, {one}));
  CHECK(peak(frames) > 0.2);
  for (std::size_t k = 0; k < frames.size(); ++k)
    CHECK(depth_in(one, double(k) + 1, frames[k]) < 1e-8);
  one.deformation_radius = 0;
  CHECK(peak(frames_met(met_scene(surface, {one}))) == 0);
  // A region that a force selects is stopped too.
  Force push = poke("push", {0, 0, 0}, 0);
  const std::vector<Field> selected = frames_met(met_scene(surface, {one}, {push}));
  CHECK(peak(selected) > 0.2);
}

TEST_CASE("contact has the same bits for every order of frames, width and number of threads",
          "[simulation][contact][threads]") {
  Scene made = met_scene(wide_mat(), dippers(), {weight_of(0.3)});
  for (std::size_t k = 0; k < made.colliders.size(); ++k) {
    made.colliders[k].name += std::to_string(k);
    made.colliders[k].transform.translate =
        vector_curve({{1, {2.0 * double(k) - 3, 3, 0}}, {6, {2.0 * double(k) - 3, -0.5, 0.3}}});
  }
  const std::vector<Field> expected = frames_met(made);
  auto other = Simulation::make(made).value();
  for (const int frame : {12, 3, 7, 1, 9})
    CHECK(other.at(frame).value().surface("s").positions() ==
          expected[static_cast<std::size_t>(frame - 1)]);
}

TEST_CASE("a squeeze ends, and the first of two colliders wins", "[simulation][contact]") {
  Collider above = ball_on_keys(1, {{1, {0, 1.2, 0}}, {8, {0, 0.2, 0}}});
  Collider below = ball_on_keys(1, {{1, {0, -1.2, 0}}, {8, {0, -0.2, 0}}});
  below.name = "below";
  const std::vector<Field> frames = frames_met(met_scene(wide_mat(), {above, below}));
  for (std::size_t k = 0; k < frames.size(); ++k) {
    REQUIRE(frames[k].allFinite());
  }
}

TEST_CASE("a fast collider carries what it meets along", "[simulation][contact]") {
  for (const Surface& surface : {wide_mat(), wide_skin()}) {
    // A hundred radii in a frame, onto a node of the mat.
    const Collider fast = ball_on_keys(0.8, {{4, {0, 40, 0}}, {5, {0, -40, 0}}});
    const std::vector<Field> frames = frames_met(met_scene(surface, {fast}));
    for (std::size_t k = 0; k < frames.size(); ++k) {
      REQUIRE(frames[k].allFinite());
      CHECK(depth_in(fast, double(k) + 1, frames[k]) < 1e-7);
    }
    if (surface.reading.uv != UvReading::Surface) CHECK(peak(frames) > 10);
  }
}

TEST_CASE("a free sheet on an incline rests or slides as its friction says",
          "[simulation][contact]") {
  for (const double friction : {0.3, 0.7}) {
    Surface surface = wide_mat();
    surface.solver.edges = {Edge::Free, Edge::Free, Edge::Free, Edge::Free};
    surface.material.damping = 0.0;
    surface.material.density = 0.5;
    surface.solver.dt = 1.0;  // one step a frame
    const double angle = 30, weight = 2;
    surface.transform.rotate = Value<3>{0, 0, -angle};
    Collider slope = floor_at(0);
    slope.transform = {.rotate = Value<3>{0, 0, -angle}};
    slope.friction = friction;
    const std::vector<Field> frames = frames_met(met_scene(surface, {slope}, {weight_of(weight)}));
    const double sine = std::sin(angle * 3.14159265358979323846 / 180);
    const double cosine = std::sqrt(1 - sine * sine), dt = 1.0 / 24;
    const Vector3d down(cosine, -sine, 0);
    double speed = 0, way = 0;
    for (std::size_t k = 1; k < frames.size(); ++k) {
      if (friction < sine / cosine) {
        speed += dt * weight * (sine - friction * cosine) / 0.5;
        way += dt * speed;
      }
      for (const Eigen::Index node : {0, 84, 168}) {
        const Vector3d gone = (frames[k].row(node) - frames[0].row(node)).transpose();
        CAPTURE(friction, k, node);
        CHECK((gone - way * down).norm() < 1e-8 * (1 + way));
      }
    }
  }
}

TEST_CASE("what sticks goes with its collider until it is let go", "[simulation][contact]") {
  for (const Surface& surface : {wide_mat(), wide_skin()}) {
    Collider finger =
        ball_on_keys(1.5, {{1, {0.1, 2, 0.1}}, {4, {0.1, 0.8, 0.1}}, {9, {1, 3, 0.5}}});
    finger.stick = switch_at({{1, true}, {9, false}});
    const std::vector<Field> frames = frames_met(met_scene(surface, {finger}));
    // Frame 9 is the last to which it is held.
    CHECK(frames[8].col(1).maxCoeff() > 0.8);
    const std::vector<Field> free = [&] {
      finger.stick = false;
      return frames_met(met_scene(surface, {finger}));
    }();
    CHECK(free[8].col(1).maxCoeff() < 0.5);
    CHECK(frames[11].col(1).maxCoeff() < frames[8].col(1).maxCoeff());
  }
}

TEST_CASE("a floor carries the weight of a free sheet, which its contacts tell at every frame",
          "[simulation][contact]") {
  Surface surface = wide_mat();
  surface.solver.edges = {Edge::Free, Edge::Free, Edge::Free, Edge::Free};
  surface.material.density = 0.5;
  const double weight = 2;
  const Scene lying = met_scene(surface, {floor_at(0)}, {weight_of(weight)});
  Simulation simulation = Simulation::make(lying).value();
  const auto contacts_at = [](Simulation& of, int frame) {
    return of.report(frame).value().surfaces[0].contacts;
  };
  const Grid& grid = simulation.rest_shapes()[0].grid.value();
  const double whole = weight * (grid.columns - 1) * grid.hu * (grid.rows - 1) * grid.hv;
  CHECK(contacts_at(simulation, 1).empty());
  std::vector<std::vector<ContactFacts>> told;
  for (int frame = 2; frame <= 12; ++frame) {
    told.push_back(contacts_at(simulation, frame));
    REQUIRE(told.back().size() == 1);
    const ContactFacts& facts = told.back()[0];
    CHECK(facts.touched);
    CHECK(facts.force.y() == Approx(whole).epsilon(1e-9));
    CHECK(std::ranges::is_sorted(facts.nodes));
    CHECK_FALSE(facts.nodes.empty());
  }
  // Backwards, from a store and from saved bytes they are the same.
  for (int frame = 12; frame >= 2; --frame)
    CHECK(contacts_at(simulation, frame) == told[frame - 2]);
  MemoryStateStore store(1 << 24);
  for (int run = 0; run < 2; ++run) {
    SimulationOptions options;
    options.store = &store;
    Simulation stored = Simulation::make(lying, options).value();
    for (int frame = 2; frame <= 12; ++frame) CHECK(contacts_at(stored, frame) == told[frame - 2]);
  }
  Simulation other = Simulation::make(lying).value();
  REQUIRE(other.restore(simulation.state_bytes(7).value()) == 7);
  CHECK(contacts_at(other, 7) == told[5]);
}

TEST_CASE("nothing touches once a collider is disabled, or a surface is not solved",
          "[simulation][contact]") {
  Collider ball = ball_on_keys(1, {{1, {0, 1.2, 0}}, {4, {0, 0.4, 0}}});
  ball.enabled = switch_at({{1, true}, {6, false}});
  Surface halted = wide_mat();
  halted.solver.time_scale = curve({{1, 1}, {6, 1}, {7, 0}});
  for (const Scene& scene : {met_scene(wide_mat(), {ball}), met_scene(halted, {ball})}) {
    Simulation simulation = Simulation::make(scene).value();
    const auto count_at = [&](int frame) {
      std::size_t count = 0;
      const FrameReport report = simulation.report(frame).value();
      for (const ContactFacts& facts : report.surfaces[0].contacts) count += facts.nodes.size();
      return count;
    };
    CHECK(count_at(1) == 0);
    CHECK(count_at(5) > 0);
    CHECK(count_at(6) > 0);  // by the solve at frame 5
    CHECK(count_at(8) == 0);
  }
}

TEST_CASE("what is inside, held or squeezed is told with its frames", "[simulation][contact]") {
  const auto warnings_of = [](const Scene& scene) {
    Simulation simulation = Simulation::make(scene).value();
    REQUIRE(simulation.at(scene.end));
    std::vector<std::string> all;
    for (const Warning& warning : simulation.warnings()) all.push_back(warning.message());
    return all;
  };
  const auto tells = [](const std::vector<std::string>& all, const std::string& words) {
    return std::ranges::count_if(
        all, [&](const std::string& one) { return one.find(words) != std::string::npos; });
  };
  for (const Surface& surface : {wide_mat(), wide_skin()}) {
    const Collider outside = ball_on_keys(2, {{1, {0, 2.5, 0}}, {6, {0, 1.5, 0}}});
    CHECK(warnings_of(met_scene(surface, {outside})).empty());

    Collider inside = ball_on_keys(2, {{1, {0.1, 1.7, 0}}});
    CHECK(tells(warnings_of(met_scene(surface, {inside})),
                "begin inside \"ball\" at frame 1, up to 0.2") == 1);
    inside.enabled = switch_at({{1, false}, {5, true}});
    CHECK(tells(warnings_of(met_scene(surface, {inside})), "inside \"ball\" at frame 5,") == 1);

    const Collider through = ball_on_keys(2, {{1, {6, 3, 0}}, {5, {6, 0, 0}}});
    CHECK(tells(warnings_of(met_scene(surface, {through})), "inside \"ball\" at frames 3-12,") ==
          1);

    const Collider above = ball_on_keys(2, {{1, {0, 2.2, 0}}, {8, {0, 1.2, 0}}});
    Collider below = ball_on_keys(2, {{1, {0, -2.2, 0}}, {8, {0, -1.2, 0}}});
    below.name = "below";
    const std::vector<std::string> squeezed = warnings_of(met_scene(surface, {above, below}));
    CHECK(tells(squeezed, "presses nodes of \"s\" against") >= 1);
    CHECK(tells(squeezed, "begin inside") == 0);

    const Collider needle = ball_on_keys(0.1, {{1, {0, 3, 0}}});
    CHECK(tells(warnings_of(met_scene(surface, {needle})),
                "\"ball\" may pass between the nodes of \"s\"") == 1);
  }
}

namespace {

// Writes what a solid of triangles is.
ClosedMesh write_mesh(const ScratchFolder& folder, const std::string& name,
                      const MeshSolid& solid) {
  std::string text;
  const Field& points = solid.posed->points();
  for (Eigen::Index k = 0; k < points.rows(); ++k)
    text += fmt::format("v {} {} {}\n", points(k, 0), points(k, 1), points(k, 2));
  for (const auto& corners : solid.posed->mesh().triangles())
    text += fmt::format("f {} {} {}\n", corners[0] + 1, corners[1] + 1, corners[2] + 1);
  return {.mesh = {.path = folder.write(name, text)}};
}

// Frames in which nothing is farther from what another collider does than 1e-8.
void check_same(const std::vector<Field>& found, const std::vector<Field>& expected) {
  REQUIRE(peak(expected) > 0.1);
  for (std::size_t k = 0; k < found.size(); ++k) {
    CAPTURE(k);
    CHECK(largest_difference(found[k], expected[k]) < 1e-8 * peak(expected));
  }
}

}  // namespace

TEST_CASE("a mesh of a box does what the box does", "[simulation][contact][mesh]") {
  const ScratchFolder folder;
  const ClosedMesh mesh = write_mesh(folder, "box.obj", box_mesh({3, 1, 2}, 3));
  Collider box = dippers()[3];
  for (Surface surface : {wide_mat(), wide_skin()}) {
    const auto compare = [&] {
      Collider other = box;
      other.shape = mesh;
      check_same(frames_met(met_scene(surface, {other}, {weight_of(0.2)})),
                 frames_met(met_scene(surface, {box}, {weight_of(0.2)})));
    };
    compare();
    box.offset = 0.0;
    compare();
    box.offset = curve({{1, 0}, {8, 0.3}});
    compare();
    box.offset = 0.05;
    box.friction = 0.4;
    compare();
    box.friction = 0;
    box.stick = switch_at({{1, true}, {8, false}});
    compare();
    box.stick = false;
    surface.solver.integrator = Integrator::Newmark;
    compare();
    surface.solver.integrator = Integrator::BackwardEuler;
    surface.solver.region = SolvedRegion::Forces;
    box.deformation_radius = 1.5;
    compare();
    box.deformation_radius = 1;
    surface.solver.region = SolvedRegion::All;
    const Channel<3> plain = box.transform.scale;
    box.transform.scale = vector_curve({{1, {0.7, 1, 1.2}}, {10, {1.1, 1.3, 0.9}}});
    compare();
    box.transform.scale = plain;
  }
}

TEST_CASE("a cache moves the mesh of a collider as keys move a box",
          "[simulation][contact][mesh]") {
  const ScratchFolder folder;
  const MeshSolid solid = box_mesh({3, 1, 2}, 2);
  ClosedMesh mesh = write_mesh(folder, "box.obj", solid);
  std::vector<Field> samples;
  std::vector<std::pair<double, Value<3>>> keys;
  for (int frame = 1; frame <= 13; ++frame) {
    // A cache has single precision.
    const Vector3d way(0.0625 * frame, 2.5 - 0.875 * std::min(frame, 14 - frame), -0.125 * frame);
    keys.push_back({double(frame), {way[0], way[1], way[2]}});
    Field points = solid.posed->points();
    points.rowwise() += way.transpose();
    samples.push_back(points);
  }
  mesh.cache.path = write_cache(folder, "box.npy", samples);
  for (const Surface& surface : {wide_mat(), wide_skin()}) {
    for (const double offset : {0.0, 0.1}) {
      for (const bool sticks : {false, true}) {
        Collider box = collider("ball", {.translate = vector_curve(keys)});
        box.shape = BoxChannels{.size = Value<3>{3, 1, 2}};
        box.offset = offset;
        box.stick = sticks;
        Collider other = box;
        other.shape = mesh;
        other.transform = {};
        check_same(frames_met(met_scene(surface, {other})), frames_met(met_scene(surface, {box})));
      }
    }
  }
}

TEST_CASE("no node enters a convex mesh, at any speed", "[simulation][contact][mesh]") {
  const ScratchFolder folder;
  const MeshSolid solid = ball_mesh(1.3, 9);
  const ClosedMesh mesh = write_mesh(folder, "ball.obj", solid);
  for (const double speed : {1.0, 40.0}) {
    for (const Surface& surface : {wide_mat(), wide_skin()}) {
      Collider ball = collider(
          "ball",
          {.translate = vector_curve(
               {{2, {0.2, 2 * speed, -0.3}}, {5, {0.6, -0.8 * speed, 0.2}}, {12, {-1, 2, 0}}}),
           .rotate = vector_curve({{1, {0, 0, 10}}, {12, {40, 90, -20}}})});
      ball.shape = mesh;
      const std::vector<Field> frames = frames_met(met_scene(surface, {ball}));
      for (std::size_t k = 0; k < frames.size(); ++k) {
        ColliderPose pose{solid, ball.transform.placement_at(double(k) + 1), 0};
        const PlacedCollider one = placed({pose, pose, 0}, 0);
        double deepest = 0;
        for (Eigen::Index n = 0; n < frames[k].rows(); ++n) {
          const Vector3d p = frames[k].row(n).transpose();
          deepest = std::max(deepest, -nearness(one.kept, one.to_frame(p)).distance);
        }
        CAPTURE(k, speed, surface.reading.uv == UvReading::Surface);
        CHECK(deepest < 1e-9 * std::sqrt(288.0) * speed);
      }
      CHECK(peak(frames) > 0.1);
    }
  }
}

TEST_CASE("contact with meshes has the same bits for every order of frames and number of threads",
          "[simulation][contact][mesh][threads]") {
  const ScratchFolder folder;
  const MeshSolid star = star_mesh();
  ClosedMesh still = write_mesh(folder, "star.obj", star), moving = still;
  std::vector<Field> samples;
  for (int k = 0; k < 13; ++k) {
    Field points = star.posed->points();
    points.col(0) *= 1 + 0.05 * k;
    points.col(1) += 0.1 * std::sin(0.7 * k) * points.col(2);
    samples.push_back(points);
  }
  moving.cache.path = write_cache(folder, "star.npy", samples);
  std::vector<Collider> colliders;
  for (const ClosedMesh& mesh : {still, moving}) {
    const double side = colliders.empty() ? -2.2 : 2.2;
    Collider one = collider(colliders.empty() ? "still" : "moving",
                            {.translate = vector_curve({{1, {side, 3, 0}}, {6, {side, -0.5, 0.3}}}),
                             .rotate = vector_curve({{1, {0, 0, 0}}, {12, {70, 20, 40}}})});
    one.shape = mesh;
    one.offset = 0.04;
    colliders.push_back(one);
  }
  for (const SolvedRegion region : {SolvedRegion::All, SolvedRegion::Forces}) {
    Surface mat = wide_mat(), other = wide_mat("t");
    mat.solver.region = other.solver.region = region;
    const Scene made = met_scene(mat, colliders, {weight_of(0.3)});
    const std::vector<Field> expected = frames_met(made);
    REQUIRE(peak(expected) > 0.1);
    Scene both = made;
    both.surfaces.push_back(other);
    SimulationOptions options;
    options.threads = 2;
    auto again = Simulation::make(both, options).value();
    for (const int frame : {12, 3, 7, 1, 9}) {
      const Frame found = again.at(frame).value();
      for (const char* name : {"s", "t"})
        CHECK(found.surface(name).positions() == expected[static_cast<std::size_t>(frame - 1)]);
    }
  }
}

TEST_CASE("what the hollow of a mesh holds stays in it", "[simulation][contact][mesh]") {
  const ScratchFolder folder;
  // A bowl: a box out of which a smaller one is cut from above.
  TriangleSoup soup;
  const auto ring = [&](double from, double to, double y0, double y1, bool turns) {
    const Vector3d corners[4] = {{1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, {-1, 0, 1}};
    for (int k = 0; k < 4; ++k) {
      const Vector3d& a = corners[k];
      const Vector3d& b = corners[(k + 1) % 4];
      const Vector3d low(0, y0, 0), high(0, y1, 0);
      if (turns) {
        soup.add_quad(from * b + low, from * a + low, to * a + high, to * b + high);
      } else {
        soup.add_quad(from * a + low, from * b + low, to * b + high, to * a + high);
      }
    }
  };
  ring(4, 4, -1, 1, false);
  ring(4, 3, 1, 1, false);
  ring(3, 3, 1, -0.6, false);
  soup.add_quad({3, -0.6, 3}, {3, -0.6, -3}, {-3, -0.6, -3}, {-3, -0.6, 3});
  soup.add_quad({4, -1, 4}, {-4, -1, 4}, {-4, -1, -4}, {4, -1, -4});
  const ClosedMesh mesh = write_mesh(folder, "bowl.obj", soup.solid());
  Surface surface = wide_mat();
  surface.solver.edges = {Edge::Free, Edge::Free, Edge::Free, Edge::Free};
  surface.transform.scale = Value<3>{0.45, 1, 0.45};
  Collider bowl =
      collider("bowl", {.translate = vector_curve({{1, {0, -0.5, 0}}, {8, {1, 0.4, 0}}})});
  bowl.shape = mesh;
  bowl.offset = 0.05;
  const std::vector<Field> frames = frames_met(met_scene(surface, {bowl}, {weight_of(1)}));
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const Value<3> at = bowl.transform.translate.at(double(k) + 1);
    CAPTURE(k);
    // Its floor is convex; at its walls a node may be a little inside.
    CHECK(frames[k].col(1).minCoeff() > at[1] - 0.55 - 1e-3);
    CHECK(frames[k].col(0).minCoeff() > at[0] - 2.95 - 0.2);
    CHECK(frames[k].col(0).maxCoeff() < at[0] + 2.95 + 0.2);
  }
}
