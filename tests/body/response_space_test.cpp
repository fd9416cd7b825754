#include "pliant/plate/response_space.hpp"

#include <cmath>

#include "pliant/body/triangle_body.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

// A square of triangles that its border holds, as one plate.
struct Held {
  explicit Held(int count)
      : body(std::make_shared<TriangleSurface>(
                 make_surface(square(count, 1, 0.2), {.unit = {{1, 1}}}).value()),
             {.measure = Measure::Rest, .region = SolvedRegion::All}) {
    inputs.frame_length = inputs.dt = 1;
    plan = body.look(inputs).value();
    const TrianglePatch& patch = plan.surface->patches[0];
    bending = bending_of(inputs, body.surface().unit, Border::Clamped);
    plate = std::make_unique<TrianglePlate>(patch.cells, patch.masses, available_solvers().front(),
                                            RunContext{});
    // A pressure, and one on a corner.
    patterns.resize(patch.free_nodes, 2);
    for (int k = 0; k < patch.free_nodes; ++k) {
      const int node = plan.surface->level_set.nodes[patch.points[k]];
      const double x = body.rest()(node, 0), z = body.rest()(node, 2);
      patterns(k, 0) = patch.masses[k];
      patterns(k, 1) = patch.masses[k] * std::exp(-20 * ((x - 0.2) * (x - 0.2) + z * z));
    }
  }

  // The displacements after frames, by steps.
  std::vector<Field> stepped(const std::vector<LoadedFrame>& frames) {
    const TrianglePatch& patch = plan.surface->patches[0];
    TriangleProblem problem;
    problem.bending = bending;
    PlateState state{Field::Zero(patch.cells.point_count, 3), Field::Zero(patch.free_nodes, 3)};
    std::vector<Field> found;
    for (const LoadedFrame& frame : frames) {
      problem.dynamics = frame.dynamics;
      problem.load = patterns.leftCols(frame.load.rows()) * frame.load;
      state = plate->advance(problem, frame.steps, std::move(state)).value();
      found.push_back(state.displacement.topRows(patch.free_nodes));
    }
    return found;
  }

  ResponseSpace space(Eigen::Index count) {
    return {vibrating(*plate, bending).value(), patterns.leftCols(count)};
  }

  TriangleBody body;
  BodyInputs inputs;
  StepPlan plan;
  Bending bending;
  std::unique_ptr<TrianglePlate> plate;
  Eigen::MatrixXd patterns;
};

// Loads that come, go and turn.
std::vector<LoadedFrame> frames_of(Eigen::Index patterns, Integrator integrator) {
  std::vector<LoadedFrame> frames;
  for (int k = 0; k < 20; ++k) {
    LoadedFrame frame{Eigen::MatrixXd::Zero(patterns, 3), {1, 3}, {4, 0.05, integrator}};
    for (Eigen::Index n = 0; n < patterns; ++n)
      frame.load.row(n) << std::sin(0.4 * k + (n == 1 ? 1 : 0)), k > 9 ? 1.0 : 0.0, 0.1 * k;
    if (k > 14) frame.dynamics = {2, 1};
    frames.push_back(frame);
  }
  return frames;
}

double largest_error(const std::vector<Field>& found, const std::vector<Field>& expected) {
  double error = 0, peak = 0;
  for (std::size_t k = 0; k < expected.size(); ++k) {
    error = std::max(error, (found[k] - expected[k]).cwiseAbs().maxCoeff());
    peak = std::max(peak, expected[k].cwiseAbs().maxCoeff());
  }
  return error / peak;
}

}  // namespace

TEST_CASE("a response space of all shapes moves a plate as its steps do", "[body][vibration]") {
  const Integrator integrator = GENERATE(Integrator::BackwardEuler, Integrator::Newmark);
  for (const Eigen::Index patterns : {1, 2}) {
    Held held(6);  // 25 nodes move
    const auto frames = frames_of(patterns, integrator);
    ResponseSpace space = held.space(patterns);
    const auto parts = space.play(frames, 25).value();
    REQUIRE(parts);
    const auto found = space.displacements(*parts);
    CHECK(largest_error(found, held.stepped(frames)) < 1e-9);  // cond ~ 1e4 x eps x 80 steps
  }
}

TEST_CASE("few shapes move a plate of many nodes nearly as its steps do", "[body][vibration]") {
  const Integrator integrator = GENERATE(Integrator::BackwardEuler, Integrator::Newmark);
  for (const Eigen::Index patterns : {1, 2}) {
    Held held(40);
    const auto frames = frames_of(patterns, integrator);
    ResponseSpace space = held.space(patterns);
    const auto parts = space.play(frames, 200).value();
    REQUIRE(parts);
    CHECK(space.shape_count() < 100);
    CHECK(largest_error(space.displacements(*parts), held.stepped(frames)) < 5e-4);
    // What is known is enough for less.
    const Eigen::Index before = space.shape_count();
    CHECK(space.play(std::span(frames).first(5), before).value());
    CHECK(space.shape_count() == before);
  }
}

TEST_CASE("too few shapes are no answer", "[body][vibration]") {
  Held held(40);
  ResponseSpace space = held.space(1);
  CHECK_FALSE(space.play(frames_of(1, Integrator::Newmark), 6).value());
}

TEST_CASE("a response space has the excited modes of its pattern", "[body][vibration]") {
  Held held(20);
  ResponseSpace space = held.space(1);
  const VibratingPlate plate = vibrating(*held.plate, held.bending).value();
  Field load = Field::Zero(held.patterns.rows(), 3);
  load.col(0) = held.patterns.col(0);
  const Eigen::VectorXd shape = plate.solve(load)->col(0);
  for (const Eigen::Index node : {0, 100, 200}) {
    const auto expected = excited_modes(plate, shape, node).value();
    const auto found = space.excited_modes(node).value();
    REQUIRE(found.size() == expected.size());
    // Rounding matters to those that are seen least.
    for (std::size_t k = 0; k < 5; ++k) {
      CHECK_THAT(found[k].lambda, WithinRel(expected[k].lambda, 1e-8));
      CHECK_THAT(found[k].share, WithinAbs(expected[k].share, 1e-8));
    }
  }
}
