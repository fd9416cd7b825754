#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "pliant/contact/node_rows.hpp"
#include "support/catch.hpp"
#include "support/met_scenes.hpp"

using namespace pliant;
using namespace pliant::testing;

// Colliders. docs/model.md, "Contact".

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

TEST_CASE("however fast a collider turns, no contact is lost", "[simulation][contact]") {
  // A node that stands still goes straight in the ball's frame, and so into the ball.
  Surface surface = light(sheet("s", 3));
  surface.solver.dt = 1.0;  // one step a frame
  Collider ball = ball_on_keys(1, {{1, {0, 1.3, 0}}});
  ball.transform.rotate = vector_curve({{1, {0, 0, 0}}, {2, {120, 0, 0}}});
  const SampledCollider turning{standing(ball, 1).first, standing(ball, 2).first, 0};
  const Vector3d node(0, 0, 0);
  const auto row = row_of(placed(turning, 0), placed(turning, 1), node, node, 1e-9);
  REQUIRE(row);
  REQUIRE(row->lack(node) > 0.1);
  const Vector3d end = node + row->lack(node) * row->normal;
  const std::vector<Field> frames = frames_met(met_scene(surface, {ball}));
  for (int k = 0; k < 3; ++k) CHECK_THAT(frames[1](4, k), WithinAbs(end[k], 1e-12));
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
