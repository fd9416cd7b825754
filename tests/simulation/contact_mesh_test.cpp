#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "contact/solid_meshes.hpp"
#include "pliant/files/obj/read_obj.hpp"
#include "pliant/scene/inputs.hpp"
#include "support/caches.hpp"
#include "support/catch.hpp"
#include "support/met_scenes.hpp"

using namespace pliant;
using namespace pliant::testing;

// Colliders that are meshes. docs/model.md, "Contact".

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

TEST_CASE("a mesh that is thinner than the nodes are apart warns as its box does",
          "[simulation][contact][mesh]") {
  const ScratchFolder folder;
  const ClosedMesh mesh = write_mesh(folder, "box.obj", box_mesh({3, 1, 2}, 3));
  const auto gaps_of = [](const Collider& one) {
    Simulation simulation = Simulation::make(met_scene(wide_mat(), {one})).value();
    std::vector<std::string> told;
    for (const Warning& warning : simulation.warnings()) {
      if (warning.kind == Warning::Kind::PassesBetween) told.push_back(warning.message());
    }
    return told;
  };
  for (const double thickness : {0.5, 1.9, 2.1, 5.0}) {
    CAPTURE(thickness);
    Collider box = dippers()[3], other = box;
    other.shape = mesh;
    box.transform.scale = other.transform.scale = Value<3>{1, -thickness, 1.5};
    const std::vector<std::string> told = gaps_of(other);
    // The nodes are 1 apart.
    CHECK(told.size() == (thickness < 2 ? 1 : 0));
    CHECK(told.size() == gaps_of(box).size());
    for (const std::string& one : told) CHECK(one.find("its least radius is at most") != one.npos);
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
    Scene given = made;  // the samples by a program
    std::get<ClosedMesh>(given.colliders[1].shape).cache = {.samples = ShapeSamples(samples)};
    CHECK(frames_met(given) == expected);
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

TEST_CASE("a collider's mesh by a program is that of a file", "[simulation][contact][mesh]") {
  using Catch::Matchers::Contains;
  const ScratchFolder folder;
  const ClosedMesh in_file = write_mesh(folder, "star.obj", star_mesh());
  const Mesh mesh = read_obj(in_file.mesh.path).value();
  Collider one =
      collider("star", {.translate = vector_curve({{1, {0, 3, 0}}, {8, {0.4, -0.5, 0}}})});
  one.shape = in_file;
  const std::vector<Field> expected = frames_met(met_scene(wide_mat(), {one}, {weight_of(0.3)}));
  REQUIRE(peak(expected) > 0.1);
  one.shape = ClosedMesh{.made = mesh};
  const Scene made = met_scene(wide_mat(), {one}, {weight_of(0.3)});
  CHECK(frames_met(made) == expected);
  CHECK(inputs_of(made).empty());

  const auto refusal = [&](const ClosedMesh& closed, const SimulationOptions& options = {}) {
    Scene bad = made;
    bad.colliders[0].shape = closed;
    const auto simulation = Simulation::make(bad, options);
    REQUIRE_FALSE(simulation);
    return simulation.error();
  };
  CHECK_THAT(refusal({.mesh = in_file.mesh, .made = mesh}).message,
             Contains("star.file: the mesh is of a file and of a program"));
  Mesh bad = mesh;
  bad.corner_vertices[4] = 1000;
  CHECK_THAT(refusal({.made = bad}).message,
             Contains("collider \"star\": corner 5 refers to vertex 1001"));
  bad = mesh;
  bad.face_sizes.pop_back();
  bad.corner_vertices.resize(bad.corner_vertices.size() - 3);
  bad.corner_uvs = bad.corner_normals = {};
  bad.corner_uvs.assign(bad.corner_vertices.size(), -1);
  CHECK_THAT(refusal({.made = bad}).message, Contains("collider \"star\": the edge between"));
  CHECK(refusal({.made = mesh}, {.max_memory = 10'000}).code == ErrorCode::OutOfMemory);
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
