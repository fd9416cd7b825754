#include <cmath>
#include <string>
#include <vector>

#include "pliant/body/grid_body.hpp"
#include "pliant/scene/read.hpp"
#include "pliant/simulation/live.hpp"
#include "support/catch.hpp"
#include "support/dense.hpp"
#include "support/meshes.hpp"
#include "support/moving_scene.hpp"
#include "support/plates.hpp"
#include "support/sanitized.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using pliant::testing::assemble_upper;
using namespace pliant::testing;
using Catch::Matchers::Contains;

namespace {

// The slowest vibration of a plate by its full matrix: eigenvalue and shape.
struct FullMode {
  double lambda = 0;
  Eigen::VectorXd shape;
};

FullMode full_mode(const Outline& outline, const Stiffness& stiffness) {
  const Eigen::MatrixXd matrix = assemble_upper({outline, stiffness, 0});
  const Modes all = modes_of(matrix.selfadjointView<Eigen::Upper>());
  return {all.values(0), all.vectors.col(0)};
}

// The scene with a damping in place of a damping ratio.
Scene with_damping(Scene s, double damping) {
  s.surfaces[0].material.damping_ratio = {};
  s.surfaces[0].material.damping = damping;
  return s;
}

Scene with_ratio(Scene s, double ratio) {
  s.surfaces[0].material.damping = MaterialChannels().damping;
  s.surfaces[0].material.damping_ratio = ratio;
  return s;
}

double apart(const Scene& a, const Scene& b) {
  const auto of_a = baked(a, "s"), of_b = baked(b, "s");
  double largest = 0;
  for (std::size_t k = 0; k < of_a.size(); ++k)
    largest = std::max(largest, largest_difference(of_a[k], of_b[k]));
  return largest / peak(of_a);
}

}  // namespace

TEST_CASE("a damping ratio is that of the slowest vibration of the region", "[simulation][ratio]") {
  Scene s = scene({sheet("s", 13)}, {poke("p", {1.5, 0, -2}, 500)});
  s.surfaces[0].solver.measure = Measure::Rest;
  const Stiffness stiffness{2, 3, 1.5};
  s.surfaces[0].material.b = stiffness.b;
  s.surfaces[0].material.c = stiffness.c;
  s.surfaces[0].material.d = stiffness.d;
  const auto report = Simulation::make(s)->report(1).value();
  const Box box = report.surfaces[0].selected;
  const double spacing = 1.0 / 12;
  const Grid grid{box.columns(), box.rows(), spacing, spacing};
  const double density = 40, ratio = 0.3;
  const double lambda = full_mode(grid, stiffness).lambda;
  const double damping = 2 * ratio * std::sqrt(lambda * density);
  CHECK(apart(with_ratio(s, ratio), with_damping(s, damping)) < 1e-8);
  CHECK(apart(with_ratio(s, ratio), with_damping(s, damping * (1 + 1e-4))) > 1e-8);
  CHECK(baked(with_ratio(s, 0), "s") == baked(with_damping(s, 0), "s"));
  // Without density there is nothing to damp.
  s.surfaces[0].material.density = 0;
  CHECK(baked(with_ratio(s, ratio), "s") == baked(with_damping(s, 0), "s"));
}

TEST_CASE("a body that is released in its slowest vibration decays by the ratio",
          "[simulation][ratio]") {
  const Grid grid{14, 11, 1.0 / 13, 1.0 / 10};
  const FullMode mode = full_mode(grid, {});
  const double density = 30, omega = std::sqrt(mode.lambda / density);
  const double ratio = GENERATE(0.02, 0.3, 0.9);
  Field rest(grid.node_count(), 3);
  for (int j = 0; j < grid.rows; ++j)
    for (int i = 0; i < grid.columns; ++i) rest.row(grid.node(i, j)) << i * grid.hu, 0, j * grid.hv;
  GridBody body(grid, rest, {.integrator = Integrator::Newmark, .region = SolvedRegion::All});
  Field way = Field::Zero(mode.shape.size(), 3);
  way.col(1) = mode.shape;
  BodyState state = body.state();
  state.positions += with_interior(grid, Field::Zero(grid.node_count(), 3), way);
  body.restore(state);
  BodyInputs inputs;
  inputs.dynamics = {density, 0};
  inputs.damping_ratio = ratio;
  // 40 frames a period.
  inputs.frame_length = 2 * 3.14159265358979 / omega / 40;
  inputs.dt = inputs.frame_length / 64;
  const double root = std::sqrt(1 - ratio * ratio);
  for (int frame = 1; frame <= (is_sanitized ? 4 : 60); ++frame) {
    REQUIRE(body.step(inputs));
    const double phase = omega * frame * inputs.frame_length;
    const double expected =
        std::exp(-ratio * phase) * (std::cos(root * phase) + ratio / root * std::sin(root * phase));
    const Field now = interior_of(grid, body.state().positions - rest);
    CAPTURE(frame);
    // The steps' own error is some (omega dt)^2 / 12 of the phase.
    CHECK((now.col(1) - expected * mode.shape).cwiseAbs().maxCoeff() <
          2e-5 * mode.shape.cwiseAbs().maxCoeff());
  }
}

TEST_CASE("each island has its own slowest vibration, a union has one", "[simulation][ratio]") {
  Force near = poke("near", {-3.5, 0, -3}, 300), far = poke("far", {3.5, 0, 3}, 300);
  near.deformation_radius = near.force_radius = 2.2;
  far.deformation_radius = far.force_radius = 1.6;
  Scene both = scene({sheet("s", 13)}, {near, far});
  both.surfaces[0].solver.measure = Measure::Rest;
  const auto alone = [&](const Force& force) {
    Scene s = both;
    s.forces = {force};
    s.surfaces[0].solver.combine = Combine::Box;
    return with_ratio(s, 0.2);
  };
  both.surfaces[0].solver.combine = Combine::Islands;
  // Islands do not touch: each moves as if alone.
  const auto frames = baked(with_ratio(both, 0.2), "s");
  const auto of_near = baked(alone(near), "s"), of_far = baked(alone(far), "s");
  for (std::size_t k = 0; k < frames.size(); ++k) {
    Field expected = of_near[k];
    for (Eigen::Index node = 0; node < expected.rows(); ++node) {
      if (of_far[k].row(node) != frames[0].row(node)) expected.row(node) = of_far[k].row(node);
    }
    CHECK((frames[k] - expected).isZero(0));
  }
  // In a union the larger one decides for both.
  both.surfaces[0].solver.combine = Combine::Union;
  const auto in_union = baked(with_ratio(both, 0.2), "s");
  const auto report = Simulation::make(alone(near))->report(1).value();
  const Box box = report.surfaces[0].selected;
  const Grid grid{box.columns(), box.rows(), 1.0 / 12, 1.0 / 12};
  const double damping = 2 * 0.2 * std::sqrt(full_mode(grid, {}).lambda * 40);
  const auto expected = baked(with_damping(both, damping), "s");
  for (std::size_t k = 0; k < frames.size(); ++k)
    CHECK(largest_difference(in_union[k], expected[k]) < 1e-8 * peak(expected));
  CHECK(in_union[11] != frames[11]);
}

TEST_CASE("frames with a damping ratio have the same bits in any order",
          "[simulation][ratio][threads]") {
  Scene s = moving_scene();
  for (Surface& surface : s.surfaces) {
    surface.material.damping = MaterialChannels().damping;
    surface.material.damping_ratio = curve({{3, 0.05}, {20, 0.4}});
  }
  const auto expected = all_states(s);
  auto simulation = Simulation::make(s, {.checkpoint_bytes = 0, .threads = 3}).value();
  for (const int frame : {28, 3, 15, 14, 22}) {
    CAPTURE(frame);
    CHECK(state_at(simulation, frame) == expected[static_cast<std::size_t>(frame - s.start)]);
  }
  auto narrow = Simulation::make(s, {.most_lanes = 2}).value();
  CHECK(state_at(narrow, 28) == expected.back());
}

TEST_CASE("patches of a surface have their own slowest vibrations, floating ones too",
          "[simulation][ratio]") {
  // A flat strip of quads, free all round.
  std::vector<Vector3d> positions;
  std::vector<std::vector<int>> faces;
  for (int i = 0; i < 6; ++i) {
    positions.insert(positions.end(), {{0.5 * i, 0, 0}, {0.5 * i, 0, 1}});
    if (i > 0) faces.push_back({2 * i - 2, 2 * i - 1, 2 * i + 1, 2 * i});
  }
  Surface strip = sheet("s");
  strip.shape = mesh_of(positions, faces);
  strip.reading.uv = UvReading::Surface;
  strip.reading.unit = std::array{1.0, 1.0};
  strip.reading.border = Border::Free;
  strip.solver.region = SolvedRegion::All;
  strip.solver.integrator = Integrator::Newmark;
  strip.material.density = 0.5;
  Force push = poke("p", {0, 0, 0.5}, 4);
  push.force_radius = 0.7;
  push.magnitude = switch_at({{1, true}, {2, false}}).channel();
  Scene s = scene({strip}, {push}, 30);
  // Damping that grows by the square of the time that the vibration takes.
  const Scene slow = with_ratio(s, 0.5);
  Scene scaled = slow;
  scaled.surfaces[0].material.density = 2.0;
  scaled.surfaces[0].solver.time_scale = 2;  // omega halves, and a frame lasts twice as long
  scaled.surfaces[0].solver.dt = 0.02;
  CHECK(apart(slow, scaled) < 1e-6);
  // The mean velocity of what nothing holds decays by eta / rho.
  const auto frames = baked(slow, "s");
  const auto mean_at = [&](int k) { return frames[k].col(1).mean(); };
  CHECK(mean_at(29) > 0);
  CHECK(mean_at(29) - mean_at(28) < mean_at(9) - mean_at(8));
}

TEST_CASE("damping and dampingRatio together are an error", "[simulation][ratio]") {
  const auto parse = [](const std::string& material) {
    return parse_scene(
        "<scene start=\"1\" end=\"2\"><surface name=\"s\"><grid columns=\"5\" "
        "rows=\"5\"/>" +
            material + "</surface></scene>",
        "scene.xml", "");
  };
  for (const char* const both :
       {"<material damping=\"1\" dampingRatio=\"0.1\"/>",
        "<material dampingRatio=\"0.1\"><animate attribute=\"damping\"><key frame=\"1\" "
        "value=\"1\"/></animate></material>",
        "<material damping=\"2\"><animate attribute=\"dampingRatio\"><key frame=\"1\" "
        "value=\"1\"/></animate></material>"}) {
    const auto refused = parse(both);
    REQUIRE_FALSE(refused);
    CHECK_THAT(refused.error().message, Contains("s.damping and s.dampingRatio are both given"));
  }
  CHECK(parse("<material dampingRatio=\"0.1\"/>"));
  const auto refused = parse("<material dampingRatio=\"-0.1\"/>");
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("dampingRatio"));
  Scene s = scene({sheet("s")}, {poke("p", {1.5, 0, -2})});
  s.surfaces[0].material.damping_ratio = 0.1;  // beside a damping of 20
  CHECK_FALSE(Simulation::make(s));
}

TEST_CASE("a live run sets a damping ratio, and no damping beside it", "[simulation][ratio]") {
  const Scene s = with_ratio(scene({sheet("s")}, {poke("p", {1.5, 0, -2})}), 0.1);
  auto live = LiveSimulation::make(s, {.records = true}).value();
  CHECK_FALSE(live.set("s.damping", 3));
  for (int k = 0; k < 4; ++k) {
    if (k == 2) CHECK(live.set("s.dampingRatio", 0.6));
    CHECK(live.advance());
  }
  const Field expected = live.positions()->surface("s").positions();
  CHECK(baked(live.performance().value(), "s").back() == expected);
}
