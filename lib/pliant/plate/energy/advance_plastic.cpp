#include "pliant/plate/energy/advance_plastic.hpp"

#include <functional>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/core/stage_timer.hpp"
#include "pliant/plate/energy/plastic_plate.hpp"
#include "pliant/plate/energy/plastic_steps.hpp"

namespace pliant {
namespace {

bool is_elastic(const PlasticField& plastic) { return plastic.isZero(0); }

// The way of a plate from step to step, on all nodes.
struct Progress {
  Field displacement, velocity;
  int steps = 0;
};

// Goes on from step to step as long as none yields.
class ElasticSteps {
 public:
  ElasticSteps(PlasticPlate& plate, const TimeSteps& steps, const PlateState& from)
      : plate_(plate),
        steps_(steps),
        plastic_(from.plastic),
        done_{from.displacement, from.velocity} {}

  // Whether the step to `next` was elastic.
  bool take(const Field& next) {
    const double dt = steps_.solved_length();
    Field& w = done_.displacement;
    Field& v = done_.velocity;
    if (plate_.yields(steps_.are_reflected() ? Field((next + w) / 2) : next, plastic_)) {
      return false;
    }
    if (steps_.are_reflected()) {
      v = (next - w) / dt - v;
    } else {
      v = (next - w) / dt;
    }
    w = next;
    ++done_.steps;
    return true;
  }

  Progress& done() { return done_; }

 private:
  PlasticPlate& plate_;
  const TimeSteps& steps_;
  const PlasticField& plastic_;
  Progress done_;
};

// The interior nodes of a rectangle, round which all others are held.
class FlowingGrid final : public FlowingPlate {
 public:
  FlowingGrid(PlateSolver& solver, PlasticPlate& plate, const Outline& outline, const Field& held)
      : solver_(solver), plate_(plate), outline_(outline), nodes_(held) {}

  Result<Field> solve(const Field& forces) override { return solver_.solve(forces); }

  bool flow(const Field& x, const PlasticField& from, PlasticField& to) override {
    nodes_ = with_interior(outline_, std::move(nodes_), x);
    return plate_.flow(nodes_, from, to);
  }

  Field forces_of(const PlasticField& plastic) override {
    Field forces = Field::Zero(plastic.rows(), 3);
    plate_.add_forces(plastic, forces);
    return interior_of(outline_, forces);
  }

  Field slope_of(const Field& way) override {
    Field forces = Field::Zero(nodes_.rows(), 3);
    plate_.add_slope(with_interior(outline_, forces, way), forces);
    return interior_of(outline_, forces);
  }

 private:
  PlateSolver& solver_;
  PlasticPlate& plate_;
  const Outline& outline_;
  Field nodes_;
};

// The problem with the forces of the plastic curvatures in the load, and without flow.
PlateProblem held(const PlateProblem& problem, const PlasticPlate& plate,
                  const PlasticField& plastic) {
  PlateProblem elastic = problem;
  elastic.law.reset();
  if (is_elastic(plastic)) return elastic;
  Field forces = Field::Zero(problem.load.rows(), 3);
  plate.add_forces(plastic, forces);
  const PlateSystem system = problem.system(1);
  const PlateEnergy energy(system);
  problem.outline.for_each_run([&](const Outline::Run& run) {
    for (int i = run.i0; i <= run.i1; ++i) {
      const int node = problem.outline.grid().node(i, run.j);
      elastic.load.row(node) += forces.row(node) / energy.share(i, run.j);
    }
  });
  return elastic;
}

}  // namespace

Result<PlateState> advance_plastic(PlateSolver& solver, const PlateProblem& problem,
                                   const TimeSteps& steps, PlateState state) {
  PLIANT_EXPECTS(problem.law && state.plastic.rows() == problem.load.rows());
  PlasticPlate plate(problem);
  PlateProblem elastic = held(problem, plate, state.plastic);
  clear_rim(problem.outline, state.velocity);
  ElasticSteps elastic_steps(plate, steps, state);
  bool yields = false;
  const std::function<bool(const Field&)> watch = [&](const Field& displacement) {
    yields = !elastic_steps.take(displacement);
    return !yields;
  };
  elastic.watch = &watch;
  auto advanced = solver.advance(elastic, steps, {state.displacement, state.velocity, {}});
  if (!advanced) return advanced;
  if (!yields) {
    advanced->plastic = std::move(state.plastic);
    return advanced;
  }
  Progress& done = elastic_steps.done();
  state.displacement = std::move(done.displacement);
  state.velocity = std::move(done.velocity);
  elastic.watch = nullptr;
  // The forces of what has flowed are not in the load from here on.
  const double dt = steps.solved_length();
  StageTimer set_up(solver.context().profile, Stage::SetUp);
  if (auto ready = solver.prepare(problem.system(dt)); !ready) return fail(ready.error());
  const StepTerms terms = solver.terms(problem, dt, state.displacement);
  set_up.stop();
  const StageTimer solving(solver.context().profile, Stage::Solve);
  const Outline& outline = problem.outline;
  Motion motion{interior_of(outline, state.displacement), interior_of(outline, state.velocity)};
  FlowingGrid flowing(solver, plate, outline, state.displacement);
  if (auto moved = run_plastic_steps(flowing, solver.context(), terms, problem.law->hardening,
                                     steps, done.steps, motion, state.plastic);
      !moved) {
    return fail(moved.error());
  }
  state.displacement = with_interior(outline, std::move(state.displacement), motion.displacement);
  state.velocity = with_interior(outline, std::move(state.velocity), motion.velocity);
  return state;
}

}  // namespace pliant
