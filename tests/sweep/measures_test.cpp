#include "pliant/sweep/measures.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

// A scene of two surfaces, one of which turns and grows as a whole.
Scene two_surfaces(int end) {
  Surface turning = sheet("turning", 7);
  turning.transform.translate = vector_curve({{1, {20, 0, 0}}, {12, {25, 3, 0}}});
  turning.transform.rotate = Value<3>{0, 40, 10};
  turning.transform.scale = Value<3>{2, 2, 2};
  return scene({sheet("still"), turning},
               {poke("left", {0, 0, 0}, 3000), poke("right", {20, 0, 0}, 900)}, end);
}

Measures measured(const Scene& scene, int first, int last) {
  auto simulation = Simulation::make(scene).value();
  Measurer measurer(simulation);
  for (int frame = scene.start; frame <= last; ++frame) {
    const Frame reached = simulation.at(frame).value();
    if (frame >= first) measurer.add(reached);
  }
  return measurer.measures().value();
}

// Straight from the definitions, in long double and without reuse.
Measures brute_force(const Scene& scene, int first, int last) {
  auto simulation = Simulation::make(scene).value();
  std::vector<Frame> frames;
  for (int frame = first; frame <= last; ++frame) frames.push_back(simulation.at(frame).value());
  long double n = 0;
  for (const RestShape& shape : simulation.rest_shapes()) n += shape.mesh.vertex_count();
  const auto squares = [&](const Field& a, const Field& b) {
    std::vector<long double> all;
    for (Eigen::Index row = 0; row < a.rows(); ++row) {
      long double square = 0;
      for (int c = 0; c < 3; ++c) {
        const long double way = static_cast<long double>(a(row, c)) - b(row, c);
        square += way * way;
      }
      all.push_back(square);
    }
    return all;
  };
  std::vector<long double> rest_most, rest_sum, moved_most, moved_sum;
  std::string bytes;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    for (auto* list : {&rest_most, &rest_sum, &moved_most, &moved_sum}) list->push_back(0);
    for (std::size_t k = 0; k < frames[f].surfaces().size(); ++k) {
      const SurfaceFrame& surface = frames[f].surfaces()[k];
      for (const auto s :
           squares(surface.object_positions(), simulation.rest_shapes()[k].mesh.positions)) {
        rest_most[f] = std::max(rest_most[f], s);
        rest_sum[f] += s;
      }
      const Field world = surface.positions();
      for (Eigen::Index row = 0; row < world.rows(); ++row) {
        for (int c = 0; c < 3; ++c) {
          char number[sizeof(double)];
          std::memcpy(number, &world(row, c), sizeof number);
          bytes.append(number, sizeof number);
        }
      }
      if (f == 0) continue;
      for (const auto s :
           squares(surface.object_positions(), frames[f - 1].surfaces()[k].object_positions())) {
        moved_most[f] = std::max(moved_most[f], s);
        moved_sum[f] += s;
      }
    }
  }
  Measures measures;
  const auto peak = std::max_element(rest_most.begin(), rest_most.end());
  const long double length = 1 / static_cast<long double>(scene.fps);
  long double sum = 0;
  for (const long double s : rest_sum) sum += s;
  measures.peak = static_cast<double>(std::sqrt(*peak));
  measures.peak_frame = first + static_cast<int>(peak - rest_most.begin());
  measures.final = static_cast<double>(std::sqrt(rest_most.back()));
  measures.rms = static_cast<double>(std::sqrt(sum / (n * frames.size())));
  measures.speed = static_cast<double>(
      std::sqrt(*std::max_element(moved_most.begin(), moved_most.end())) / length);
  measures.energy = static_cast<double>(*std::max_element(moved_sum.begin(), moved_sum.end()) /
                                        (2 * n * length * length));
  // The first frame after which all steps are short.
  for (std::size_t f = 0; f < frames.size(); ++f) {
    measures.settle = first + static_cast<int>(f);
    if (*peak == 0) break;
    if (std::all_of(moved_most.begin() + static_cast<long>(f) + 1, moved_most.end(),
                    [&](long double s) { return std::sqrt(s) <= std::sqrt(*peak) / 1000; }))
      break;
  }
  measures.hash = hash_of(bytes);
  return measures;
}

void check_equal(const Measures& a, const Measures& b) {
  // Sums of a few thousand terms of one sign.
  CHECK_THAT(a.peak, WithinRel(b.peak, 1e-13));
  CHECK(a.peak_frame == b.peak_frame);
  CHECK_THAT(a.final, WithinRel(b.final, 1e-13));
  CHECK_THAT(a.rms, WithinRel(b.rms, 1e-13));
  CHECK_THAT(a.speed, WithinRel(b.speed, 1e-13));
  CHECK_THAT(a.energy, WithinRel(b.energy, 1e-13));
  CHECK(a.settle == b.settle);
  CHECK(a.hash == b.hash);
}

}  // namespace

TEST_CASE("measures are those of their definitions", "[sweep][measures]") {
  const auto [first, last] = GENERATE(table<int, int>({{1, 12}, {4, 9}, {7, 7}, {1, 2}}));
  check_equal(measured(two_surfaces(12), first, last), brute_force(two_surfaces(12), first, last));
}

TEST_CASE("a damped poke settles inside of the run", "[sweep][measures]") {
  Surface damped = sheet("damped");
  damped.material.damping = 400.0;
  Force short_poke = poke("poke", {0, 0, 0});
  short_poke.magnitude = curve({{1, 5000}, {4, 0}, {60, 0}});
  const Scene poked = scene({damped}, {short_poke}, 60);
  const Measures measures = measured(poked, 1, 60);
  check_equal(measures, brute_force(poked, 1, 60));
  CHECK(measures.settle > 1);
  CHECK(measures.settle < 60);
  CHECK(measures.peak_frame < measures.settle);
}

TEST_CASE("what never moves has settled from the first frame", "[sweep][measures]") {
  const Measures measures = measured(scene({sheet("still")}, {}, 5), 2, 5);
  CHECK(measures.peak == 0);
  CHECK(measures.peak_frame == 2);
  CHECK(measures.settle == 2);
  CHECK(measures.speed == 0);
  CHECK(measures.energy == 0);
}

TEST_CASE("one frame has no speed", "[sweep][measures]") {
  const Measures measures = measured(two_surfaces(12), 8, 8);
  CHECK(measures.peak > 0);
  CHECK(measures.peak == measures.final);
  CHECK(measures.speed == 0);
  CHECK(measures.energy == 0);
  CHECK(measures.settle == 8);
}

TEST_CASE("a measure beyond all numbers is an error", "[sweep][measures]") {
  auto simulation = Simulation::make(scene({sheet("a", 3)}, {}, 2)).value();
  Measurer measurer(simulation);
  measurer.add(Frame(1, {SurfaceFrame("a", Field::Constant(9, 3, 1e200), {}, 0)}));
  const auto measures = measurer.measures();
  REQUIRE_FALSE(measures);
  CHECK(measures.error().code == ErrorCode::NotFinite);
  CHECK_THAT(measures.error().message, contains_text("peak"));
}
