#include "pliant/sampling/animated_shape.hpp"

#include <limits>
#include <thread>

#include "pliant/sampling/rest_shape.hpp"
#include "support/caches.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

namespace {

Field moved(const Field& rest, double along) {
  return rest.rowwise() + Eigen::RowVector3d(along, 0, 0);
}

// A sheet of 3 x 3 whose samples are moved along x by these ways.
std::vector<Field> ways(const std::vector<double>& along) {
  std::vector<Field> samples;
  for (const double way : along) samples.push_back(moved(sheet_vertices(3), way));
  return samples;
}

Scene with_cache(const std::string& cache, Surface surface, int end = 12) {
  surface.cache.path = cache;
  return scene({std::move(surface)}, {}, end);
}

Result<ReservedShape> made(const Scene& scene, const RunContext& context = {}) {
  auto shape = make_rest_shape(scene.surfaces[0], scene.origin, context);
  REQUIRE(shape);
  auto animated = animate(*shape, scene.surfaces[0], scene, context);
  if (!animated) return fail(animated.error());
  return shape;
}

double way_of(const Field& field) { return field(0, 0) - sheet_vertices(3)(0, 0); }

std::string refusal(const Scene& scene) {
  const auto shape = made(scene);
  REQUIRE_FALSE(shape);
  CHECK(to_lines(shape.error()).size() == 1);
  return shape.error().message;
}

}  // namespace

TEST_CASE("an animated shape is exact at samples, linear between and held outside",
          "[sampling][cache]") {
  const ScratchFolder folder;
  Scene s = with_cache(write_cache(folder, "a.npy", ways({0, 1, 4, 2})), sheet("s", 3));
  s.surfaces[0].cache.first = 2;
  const auto shape = made(s)->shape.animation;
  const std::vector<double> expected = {0, 0, 1, 4, 2, 2, 2};
  for (const int frame : {5, 1, 7, 3, 2, 6, 4}) {
    CAPTURE(frame);
    CHECK(way_of(**shape->nodes_at(frame)) == expected[static_cast<std::size_t>(frame - 1)]);
    CHECK(*shape->vertices_at(frame).value() == *shape->nodes_at(frame).value());
  }
  s.surfaces[0].cache.first = 1.25;
  const auto between = made(s)->shape.animation;
  CHECK(way_of(**between->nodes_at(1)) == 0);
  CHECK_THAT(way_of(**between->nodes_at(2)), WithinAbs(0.75, 1e-15));
  CHECK_THAT(way_of(**between->nodes_at(3)), WithinAbs(1 + 0.75 * 3, 1e-15));
}

TEST_CASE("neighbours of a frame mirror each other at the ends of the samples",
          "[sampling][cache]") {
  const ScratchFolder folder;
  Scene s = with_cache(write_cache(folder, "a.npy", ways({0, 1, 4, 2})), sheet("s", 3));
  s.surfaces[0].cache.first = 3;
  const auto shape = made(s)->shape.animation;
  const auto check = [&](int frame, std::vector<double> expected) {
    CAPTURE(frame);
    const ShapeFrames around = shape->frames_around(frame).value();
    CHECK(way_of(*around.before) == expected[0]);
    CHECK(way_of(*around.now) == expected[1]);
    CHECK(way_of(*around.after) == expected[2]);
  };
  check(1, {0, 0, 0});
  check(2, {0, 0, 0});
  check(3, {-1, 0, 1});  // mirrored
  check(4, {0, 1, 4});
  check(5, {1, 4, 2});
  check(6, {4, 2, 0});  // mirrored
  check(7, {2, 2, 2});
  Scene one = with_cache(write_cache(folder, "b.npy", ways({5})), sheet("s", 3));
  const ShapeFrames alone = made(one)->shape.animation->frames_around(1).value();
  CHECK(way_of(*alone.before) == 5);
  CHECK(way_of(*alone.after) == 5);
}

TEST_CASE("an animated shape in a cycle comes again, before its start too", "[sampling][cache]") {
  const ScratchFolder folder;
  const std::string file = write_cache(folder, "a.npy", ways({9, 0, 1, 4, 2, 9}));
  const auto rest = make_rest_shape(sheet("s", 3), {})->shape;
  auto cache = PointCache::open(file).value();
  auto frames = cache.frames(10, 1, 24).value();
  // Frames 11 to 14; the samples before and after are not read.
  const AnimatedShape shape(std::move(cache), std::move(frames), rest, ShapeCycle{11, 4});
  const std::vector<double> expected = {0, 1, 4, 2};
  const auto at = [&](int frame) { return way_of(**shape.nodes_at(frame)); };
  for (int frame = -9; frame < 40; ++frame) {
    CAPTURE(frame);
    const double now = expected[static_cast<std::size_t>((frame + 29) % 4)];
    CHECK(at(frame) == now);
    const ShapeFrames around = shape.frames_around(frame).value();
    CHECK(way_of(*around.before) == at(frame - 1));
    CHECK(way_of(*around.now) == now);
    CHECK(way_of(*around.after) == at(frame + 1));
  }
}

TEST_CASE("an animated shape is the same in any order of frames and from any thread",
          "[sampling][cache][threads]") {
  const ScratchFolder folder;
  std::vector<double> along;
  for (int k = 0; k < 40; ++k) along.push_back(0.1 * k * k);
  Scene s = with_cache(write_cache(folder, "a.npy", ways(along)), sheet("s", 3));
  s.surfaces[0].cache.first = 0.5;
  const auto shape = made(s)->shape.animation;
  const auto fresh = [&](int frame) { return *made(s)->shape.animation->nodes_at(frame).value(); };
  const auto visit = [&](int step) {
    for (int k = 0; k < 80; ++k) {
      const int frame = k * step % 43 - 1;
      if (!(*shape->nodes_at(frame).value() == *shape->nodes_at(frame).value())) std::abort();
    }
  };
  std::thread other(visit, 7);
  visit(5);
  other.join();
  for (const int frame : {40, 3, 17, 16, 3}) CHECK(*shape->nodes_at(frame).value() == fresh(frame));
}

TEST_CASE("a cache that does not fit its shape is refused before the run", "[sampling][cache]") {
  const ScratchFolder folder;
  CHECK_THAT(refusal(with_cache(write_cache(folder, "a.npy", ways({0})), sheet("s", 4))),
             Contains("it has 9 vertices, but the shape has 16"));
  auto samples = ways({0, 1, 2, 3, 4});
  samples[3](4, 1) = std::numeric_limits<double>::quiet_NaN();
  const std::string bad = write_cache(folder, "b.npy", samples);
  Scene s = with_cache(bad, sheet("s", 3));
  s.surfaces[0].cache.first = 10;
  CHECK_THAT(refusal(s), Contains("sample 3, at frame 13: vertex 4 is at (") && Contains("nan") &&
                             Contains("must be finite"));
  s.end = 11;  // frame 13 is not asked for
  CHECK(made(s));
  CHECK_THAT(refusal(with_cache(folder.file("none.pc2").string(), sheet("s", 3))),
             Contains("none.pc2") && Contains("cannot read"));
  MemoryBudget little(3000);
  const auto shape = made(with_cache(write_cache(folder, "c.npy", ways({0})), sheet("s", 3)));
  REQUIRE(shape);
  ReservedShape poor{shape->shape, MemoryShare(&little)};
  const Scene again = with_cache(folder.file("c.npy").string(), sheet("s", 3));
  CHECK(animate(poor, again.surfaces[0], again).error().code == ErrorCode::OutOfMemory);
}

TEST_CASE("samples of a program are checked and counted as those of a file", "[sampling][cache]") {
  const auto with_samples = [](std::vector<Field> samples) {
    Scene s = with_cache("", sheet("s", 3));
    s.surfaces[0].cache.samples = ShapeSamples(std::move(samples));
    return s;
  };
  Field eight = Field::Zero(8, 3);
  CHECK_THAT(refusal(with_samples({eight})),
             Contains("surface \"s\": its cache has 8 vertices, but the shape has 9"));
  CHECK_THAT(refusal(with_samples({ways({0})[0], eight})),
             Contains("surface \"s\": sample 1 has 8 vertices, but sample 0 has 9"));
  CHECK_THAT(refusal(with_samples({Field(0, 3)})), Contains("sample 0 has no vertices"));
  auto samples = ways({0, 1, 2, 3, 4});
  samples[3](4, 1) = std::numeric_limits<double>::infinity();
  Scene s = with_samples(samples);
  s.surfaces[0].cache.first = 10;
  CHECK_THAT(refusal(s), Contains("surface \"s\": sample 3, at frame 13: vertex 4 is at (") &&
                             Contains("inf") && Contains("must be finite"));
  s.end = 11;  // frame 13 is not asked for
  CHECK(made(s));
  // A longer cache takes more, by what it is.
  const auto bytes = [&](int count) {
    MemoryBudget plenty(1U << 30U);
    RunContext context;
    context.memory = &plenty;
    const auto shape =
        made(with_samples(ways(std::vector<double>(static_cast<std::size_t>(count), 1))), context);
    return shape->memory.bytes();
  };
  CHECK(bytes(1000) - bytes(1) >= 999 * 9 * 3 * sizeof(double));
  MemoryBudget little(100'000);
  RunContext context;
  context.memory = &little;
  CHECK(made(with_samples(ways({0})), context));
  const auto large = made(with_samples(ways(std::vector<double>(1000, 0))), context);
  REQUIRE_FALSE(large);
  CHECK(large.error().code == ErrorCode::OutOfMemory);
}

TEST_CASE("vertices of one node of a grid must stay together, those of a surface need not",
          "[sampling][cache]") {
  const ScratchFolder folder;
  Mesh twin = make_mesh({.columns = 3, .rows = 3});
  // Vertex 9 is in the place of vertex 8, in a face of its own.
  twin.positions.conservativeResize(10, 3);
  twin.positions.row(9) = twin.positions.row(8);
  twin.face_sizes.push_back(3);
  for (const int vertex : {4, 7, 9}) {
    twin.corner_vertices.push_back(vertex);
    twin.corner_uvs.push_back(std::min(vertex, 8));
  }
  Surface surface = sheet("s", 3);
  surface.shape = twin;
  Field apart = twin.positions;
  apart(9, 1) += 0.25;
  const std::string cache = write_cache(folder, "a.npy", {twin.positions, apart});
  surface.reading.uv = UvReading::Grid;
  Scene s = with_cache(cache, surface);
  const auto shape = make_rest_shape(surface, s.origin);
  REQUIRE(shape);
  REQUIRE(shape->shape.grid);
  CHECK_THAT(refusal(s), Contains("sample 1, at frame 2: vertices 8 and 9 are one node of the "
                                  "grid, but 0.25 apart"));
  surface.reading.uv = UvReading::Surface;
  s = with_cache(cache, surface);
  const auto on_triangles = made(s);
  REQUIRE(on_triangles);
  CHECK(*on_triangles->shape.animation->vertices_at(2).value() == apart);
  CHECK(on_triangles->shape.animation->nodes_at(2).value()->row(8) == apart.row(8));
}
