#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "pliant/core/expects.hpp"
#include "pliant/core/stage_timer.hpp"
#include "pliant/plate/advance.hpp"
#include "pliant/plate/contact/advance_with_contact.hpp"
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

// Goes on from step to step as long as none yields, and nothing touches.
class ElasticSteps {
 public:
  ElasticSteps(const PlasticPlate& plate, const PlateProblem& problem, const TimeSteps& steps,
               const PlateState& from)
      : plate_(plate),
        outline_(problem.outline),
        contact_(problem.contact),
        steps_(steps),
        plastic_(from.plastic),
        done_{from.displacement, from.velocity} {}

  // Whether the step to `next` was elastic, and nothing touched.
  bool take(const Field& next) {
    const double dt = steps_.solved_length();
    Field& w = done_.displacement;
    Field& v = done_.velocity;
    if (steps_.are_reflected()) {
      Field solved = w;
      for (const int k : plate_.components()) solved.col(k) = (next.col(k) + w.col(k)) / 2;
      if (plate_.yields(solved, plastic_)) return false;
    } else if (plate_.yields(next, plastic_)) {
      return false;
    }
    if (contact_ &&
        contact_->begin(done_.steps, interior_of(outline_, w), interior_of(outline_, next))) {
      return false;
    }
    for (const int k : plate_.components()) {
      if (steps_.are_reflected()) {
        v.col(k) = (next.col(k) - w.col(k)) / dt - v.col(k);
      } else {
        v.col(k) = (next.col(k) - w.col(k)) / dt;
      }
      w.col(k) = next.col(k);
    }
    ++done_.steps;
    return true;
  }

  Progress& done() { return done_; }

 private:
  const PlasticPlate& plate_;
  const Outline& outline_;
  StepContact* contact_;  // null: nothing is there to touch
  const TimeSteps& steps_;
  const PlasticField& plastic_;
  Progress done_;
};

// The interior nodes of a rectangle, round which all others are held.
class FlowingGrid final : public FlowingPlate {
 public:
  FlowingGrid(PlateSolver& solver, const PlasticPlate& plate, const Outline& outline,
              const Field& held)
      : solver_(solver),
        plate_(plate),
        outline_(outline),
        numbers_(numbers_of_unknowns(outline)),
        nodes_(held) {}

  Result<void> solve(const std::vector<int>& components, const Field& forces,
                     std::span<const UnknownRun> runs, Field& solution) override {
    return solver_.solve_for(components, forces, runs, solution);
  }

  Field forces_of(const PlasticField& plastic) override {
    Field forces = Field::Zero(plastic.rows(), 3);
    plate_.add_forces(plastic, forces);
    return interior_of(outline_, forces);
  }

  std::vector<int> places_over(double part, const Field& x, const PlasticField& from) override {
    nodes_ = with_interior(outline_, std::move(nodes_), x);
    return plate_.nodes_over(part, nodes_, from);
  }

  PlaceRows rows_of(const std::vector<int>& places) override {
    return plate_.rows_of(places, numbers_, nodes_);
  }

 private:
  PlateSolver& solver_;
  const PlasticPlate& plate_;
  const Outline& outline_;
  std::vector<int> numbers_;
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

// The steps of a grid. What is given outlives them.
Result<OwnedSteps> make_steps(PlateSolver& solver, const PlasticPlate& plate,
                              const PlateProblem& problem, const Field& held,
                              const TimeSteps& steps, const PlasticField& plastic) {
  const StageTimer set_up(solver.context().profile, Stage::SetUp);
  const double dt = steps.solved_length();
  if (auto ready = solver.prepare(problem.system(dt)); !ready) return fail(ready.error());
  StepTerms terms = solver.terms(problem, dt, held);
  OwnedSteps made{std::make_unique<FlowingGrid>(solver, plate, problem.outline, held), {}};
  if (problem.contact) made.matrix = contact_matrix(solver, problem, dt, terms.shift);
  made.steps = make_plastic_steps(*made.plate, solver.context(), std::move(terms),
                                  problem.law->hardening, steps, plate.components(), plastic);
  return made;
}

// The steps from `first` on, in which something touches.
Result<void> meet_on(PlateSolver& solver, const ContactHelp& help, const PlateProblem& problem,
                     const TimeSteps& steps, int first, const Field& held, Motion& motion,
                     PlasticField& plastic) {
  const PlasticPlate plate(problem, {0, 1, 2}, kernels_of_width(solver.context().most_lanes));
  help.memory.keep_for(problem.system(steps.length));
  const TimeSteps whole_steps{.count = steps.count, .length = steps.length};
  const MetPlate met{*problem.contact, help.memory.problem,
                     [&](const PlasticField& from) {
                       return make_steps(solver, plate, problem, held, steps, from);
                     },
                     [&](const PlasticField& from) {
                       return make_steps(help.whole, plate, problem, held, whole_steps, from);
                     }};
  return run_met_steps(met, solver.context(), steps, first, motion, plastic);
}

// Steps that flow from `first` on. If that one does not, nothing happens, and none is done.
Result<bool> flow_on(PlateSolver& solver, const PlasticPlate& plate, const PlateProblem& problem,
                     const TimeSteps& steps, int first, bool is_expected, PlateState& state,
                     const ContactHelp* help) {
  const double dt = steps.solved_length();
  const Outline& outline = problem.outline;
  PlasticField& plastic = state.plastic;  // grows with the first step that flows
  auto all = make_steps(solver, plate, problem, state.displacement, steps, plastic);
  if (!all) return fail(all.error());
  const StageTimer solving(solver.context().profile, Stage::Solve);
  Motion motion{interior_of(outline, state.displacement), interior_of(outline, state.velocity)};
  if (is_expected) {
    all->steps->expect(motion.displacement + dt * motion.velocity,
                       motion.displacement + steps.count * dt * motion.velocity, plastic);
  }
  for (int number = first; number < steps.count; ++number) {
    const auto tried = try_step(*all->steps, number, problem.contact, motion, plastic);
    if (!tried) return fail(tried.error());
    if (!tried->stands) {
      auto met =
          meet_on(solver, *help, problem, steps, number, state.displacement, motion, plastic);
      if (!met) return fail(met.error());
      break;
    }
    if (number == first && is_expected && !tried->flowed) return false;
  }
  state.displacement = with_interior(outline, std::move(state.displacement), motion.displacement);
  state.velocity = with_interior(outline, std::move(state.velocity), motion.velocity);
  return true;
}

}  // namespace

Result<PlateState> advance_plastic(PlateSolver& solver, const PlateProblem& problem,
                                   const TimeSteps& steps, PlateState state,
                                   const ContactHelp* help) {
  PLIANT_EXPECTS(problem.law && state.plastic.rows() == problem.load.rows());
  PLIANT_EXPECTS((problem.contact != nullptr) == (help != nullptr));
  clear_rim(problem.outline, state.velocity);
  const PlasticPlate plate(problem,
                           components_at_work(problem.tangents, problem.load, state.displacement,
                                              state.velocity, state.plastic),
                           kernels_of_width(solver.context().most_lanes));
  // A plate that goes on as it moves and yields then is not tried elastically.
  const Field next = state.displacement + steps.solved_length() * state.velocity;
  if (plate.yields(next, state.plastic)) {
    const auto flowed = flow_on(solver, plate, problem, steps, 0, true, state, help);
    if (!flowed) return fail(flowed.error());
    if (*flowed) return state;
  }
  PlateProblem elastic = held(problem, plate, state.plastic);
  elastic.contact = nullptr;
  ElasticSteps elastic_steps(plate, problem, steps, state);
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
  const auto flowed = flow_on(solver, plate, problem, steps, done.steps, false, state, help);
  if (!flowed) return fail(flowed.error());
  return state;
}

}  // namespace pliant
