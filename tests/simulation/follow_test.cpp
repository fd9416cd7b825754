#include "pliant/forces/force.hpp"
#include "support/caches.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"

using namespace pliant;
using namespace pliant::testing;

// Forces that follow a surface. SPEC 7.

namespace {

// Keys of a rigid motion: it turns about all axes and goes its way.
TransformChannels rigid_motion() {
  return {.translate = vector_curve({{1, {3, -1, 2}}, {6, {-2, 4, 1}}, {12, {5, 0, -7}}}),
          .rotate = vector_curve({{1, {20, 0, 0}}, {7, {140, -60, 30}}, {12, {-90, 45, 200}}}),
          .rotate_order = RotateOrder::Yzx};
}

// One force of each kind that may follow, and a group, all at places of the sheet.
std::vector<Force> followers(const std::string& surface) {
  std::vector<Force> forces = {poke("point", {-2, 0, 1}),      poke("radial", {2, 0.5, -1}),
                               poke("line", {0, 0, 0}),        poke("vortex", {1, 0, 2}, 900),
                               poke("noise", {0, 0, 0}, 2000), poke("pressure", {-1, 0, -2}),
                               poke("member", {0, 0, 1})};
  forces[0].kind = PointChannels{.center = vector_curve({{1, {-2, 0, 1}}, {9, {2, 0, 0}}}),
                                 .direction = Value<3>{0.5, 1, -0.2}};
  forces[1].kind = RadialChannels{.center = Value<3>{2, 0.5, -1}};
  forces[2].kind = LineChannels{.from = Value<3>{-2, 0.2, -2},
                                .to = vector_curve({{1, {2, 0, 2}}, {10, {3, 1, -2}}})};
  forces[3].kind = VortexChannels{.center = Value<3>{1, 0, 2}, .axis = Value<3>{0.3, 1, 0}};
  forces[4].kind = NoiseChannels{.center = Value<3>{0.3, 0, 0.1}, .frequency = 0.4, .rate = 3.0};
  forces[5].kind = PressureChannels{.center = Value<3>{-1, 0, -2}};
  forces[6].group = "both";
  forces[0].along = PushAlong::Normal;
  for (Force& force : forces) force.follow = surface;
  return forces;
}

Group group_at(const Value<3>& center, const std::string& surface) {
  Group group;
  group.name = "both";
  group.follow = surface;
  group.center = center;
  group.deformation_radius = 3.3;  // no node is as far
  return group;
}

Scene following(Surface surface, const std::string& followed) {
  Scene made = scene({std::move(surface)}, followers(followed));
  made.groups = {group_at({0, 0, 1}, followed)};
  return made;
}

// The frames in the object space of a surface with that motion.
std::vector<Field> in_object_space(std::vector<Field> frames, const TransformChannels& motion) {
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const Transform transform = motion.at(static_cast<double>(k) + 1);
    frames[k].rowwise() -= transform.translation.transpose();
    frames[k] = vectors_to_object(transform, frames[k]);
  }
  return frames;
}

Surface of_triangles(Surface surface) {
  surface.shape = square(12, 12, 0.2);
  surface.reading.uv = UvReading::Surface;
  return surface;
}

// Each surface both ways: as a grid and as triangles.
std::vector<Surface> both_ways() { return {sheet("s"), of_triangles(sheet("s"))}; }

std::string message_of(const Scene& scene) {
  const auto made = Simulation::make(scene);
  return made ? "" : made.error().message;
}

}  // namespace

TEST_CASE("a force that follows does in object space what it does on a surface that stands",
          "[simulation][follow]") {
  for (Surface surface : both_ways()) {
    const std::vector<Field> expected = baked(following(surface, ""), "s");
    surface.transform = rigid_motion();
    const std::vector<Field> found =
        in_object_space(baked(following(surface, "s"), "s"), surface.transform);
    REQUIRE(peak(expected) > 0.1);
    for (std::size_t k = 0; k < found.size(); ++k)
      CHECK(largest_difference(found[k], expected[k]) < 1e-10 * peak(expected));
  }
}

// Of static frames the displacement turns with the load, whatever was before.
TEST_CASE("a cache that moves rigidly turns what follows it", "[simulation][follow]") {
  const ScratchFolder folder;
  const TransformChannels motion = rigid_motion();
  const Transform start = motion.at(1);
  for (Surface surface : both_ways()) {
    surface.material.density = surface.material.damping = 0.0;
    surface.solver.measure = Measure::Rest;
    surface.solver.region = SolvedRegion::All;  // what a region leaves behind does not turn
    const auto* const mesh = std::get_if<Mesh>(&surface.shape);
    const Field rest = mesh ? mesh->positions : sheet_vertices();
    const std::vector<Field> expected = baked(following(surface, ""), "s");
    std::vector<Field> shapes;
    std::vector<Matrix3d> turns;
    for (int frame = 1; frame <= 12; ++frame) {
      const Transform now = motion.at(frame);
      turns.push_back(now.linear * start.linear.transpose());
      shapes.push_back(to_world({turns.back(), now.translation}, rest));
    }
    // At the start it stands as it was made, but for a way that the places go too.
    Scene cached = following(surface, "s");
    cached.surfaces[0].cache = {write_cache(folder, "moved.npy", shapes), 1};
    const auto shift = [&](PositionChannel& place) {
      CurveKeys<3> keys;
      for (int frame = 1; frame <= 12; ++frame) {
        Key<3> key{.frame = double(frame), .value = place.at(frame)};
        for (int k = 0; k < 3; ++k) key.value[k] += start.translation[k];
        keys.keys.push_back(key);
      }
      place = Curve<3>::make(std::move(keys)).value();
    };
    const auto shift_center = [&](auto& kind) {
      if constexpr (requires { kind.center; }) shift(kind.center);
      if constexpr (requires { kind.from; }) shift(kind.from), shift(kind.to);
    };
    for (Force& force : cached.forces) std::visit(shift_center, force.kind);
    shift(cached.groups[0].center);
    const std::vector<Field> found = baked(cached, "s");
    REQUIRE(peak(expected) > 0.1);
    for (std::size_t k = 1; k < found.size(); ++k) {
      const Field own = (expected[k] - rest) * turns[k - 1].transpose();
      CHECK(largest_difference(found[k] - shapes[k], own) < 1e-9 * peak(expected));
    }
  }
}

TEST_CASE("a force follows a surface that it does not push", "[simulation][follow]") {
  const std::vector<Field> expected = baked(following(sheet("s"), ""), "s");
  for (const int kind : {0, 1, 2}) {
    Surface carrier = sheet("carrier");
    carrier.enabled = kind != 0;
    if (kind == 1) carrier.shape = square(4, 4, 0.1);
    if (kind == 2) {
      NurbsNet net{.u = {.count = 4, .degree = 2}, .v = {.count = 4, .degree = 3}};
      net.points = make_mesh(GridSheet{.columns = 4, .rows = 4}).positions;
      carrier.shape = net;
    }
    Scene made = following(sheet("s"), "carrier");
    for (Force& force : made.forces) force.targets = {"s"};
    made.groups[0].targets = {"s"};
    made.surfaces.push_back(carrier);
    const std::vector<Field> still = baked(made, "s");
    for (std::size_t k = 0; k < still.size(); ++k)
      CHECK(largest_difference(still[k], expected[k]) < 1e-13 * peak(expected));
    made.surfaces[1].transform = rigid_motion();
    CHECK(largest_difference(baked(made, "s").back(), expected.back()) > 0.01 * peak(expected));
  }
}

TEST_CASE("of triangles that are equally near the first one carries", "[simulation][follow]") {
  // Two triangles that fold about their common edge, on which the place lies: rounding does not
  // decide between them.
  const ScratchFolder folder;
  const std::vector<Vector3d> corners = {{0.1, 0, 0}, {0.7, 0, 1.3}, {-1, 0, 1}, {2, 0, 0.2}};
  const Vector3d place = 0.3 * corners[0] + 0.7 * corners[1];
  const int first = GENERATE(0, 1);
  const std::vector<std::vector<int>> faces = {{0, 1, 2}, {1, 0, 3}};
  Surface carrier = sheet("carrier");
  carrier.shape = mesh_of(corners, {faces[first], faces[1 - first]});
  carrier.reading.uv = UvReading::Surface;
  Field folded = std::get<Mesh>(carrier.shape).positions;
  folded(3, 1) += 3;  // the second of `faces` turns
  carrier.cache = {
      write_cache(folder, "fold.npy", {std::get<Mesh>(carrier.shape).positions, folded}), 1};
  Scene made = scene({sheet("s"), carrier}, {poke("push", {place.x(), place.y(), place.z()})}, 3);
  made.forces[0].targets = {"s"};
  made.forces[0].follow = "carrier";
  auto simulation = Simulation::make(made).value();
  const FrameReport report = simulation.report(2).value();
  const ForceReport& told = report.surfaces[0].forces[0];
  const auto& found = std::get<PointForce>(told.sampled->kind);
  CHECK((found.center - place).norm() < 1e-12);
  const bool stays = (found.direction - Vector3d(0, 1, 0)).norm() < 1e-12;
  CHECK(stays == (first == 0));
}

TEST_CASE("what cannot be followed is said", "[simulation][follow]") {
  const ScratchFolder folder;
  Scene made = scene({sheet("s")}, {poke("push", {0, 0, 0})}, 4);
  made.forces[0].follow = "body";
  CHECK(message_of(made) == "push.follow: no surface is named \"body\"; allowed: s");
  Surface driven = sheet("skin");
  driven.driven_by = "s";
  made.surfaces.push_back(driven);
  made.forces[0].follow = "skin";
  CHECK(message_of(made) == "push.follow: \"skin\" is driven by \"s\"; follow that one");
  made.forces[0].follow = "s";
  CHECK(message_of(made).empty());
  made.forces[0].kind = InertiaChannels{};
  CHECK(message_of(made) == "push.follow: a force of kind inertia has no place");
  made.forces[0].kind = RadialChannels{};
  made.forces[0].along = PushAlong::Normal;
  CHECK(message_of(made) == "push.along: a force of kind radial has no direction");
  made.groups = {group_at({0, 0, 0}, "nobody")};
  made.forces[0].along = PushAlong::Free;
  CHECK(message_of(made).starts_with("both.follow: no surface is named \"nobody\""));
}

TEST_CASE("a triangle that loses its area carries nothing, and the frame is said",
          "[simulation][follow]") {
  const ScratchFolder folder;
  const Field rest = sheet_vertices();
  Field flat = rest;
  flat.col(2).setZero();
  Surface carrier = sheet("carrier");
  carrier.cache = {write_cache(folder, "flat.npy", {rest, rest, flat}), 1};
  Scene made = scene({sheet("s"), carrier}, {poke("push", {0.3, 0, 0.4})}, 5);
  made.forces[0].targets = {"s"};
  made.forces[0].follow = "carrier";
  auto simulation = Simulation::make(made).value();
  CHECK(simulation.at(3));
  const auto failed = simulation.at(4);
  REQUIRE(!failed);
  CHECK_THAT(
      failed.error().message,
      contains_text("push follows carrier: the triangle that carries it has no area at frame 3"));
  made.surfaces[1].cache = {write_cache(folder, "none.npy", {flat, rest}), 1};
  CHECK(message_of(made).find(
            "surface \"carrier\" cannot be followed: none of its triangles has an area") !=
        std::string::npos);
}
