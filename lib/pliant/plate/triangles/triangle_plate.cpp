#include "pliant/plate/triangles/triangle_plate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/core/stage_timer.hpp"
#include "pliant/plate/contact/contact_steps.hpp"
#include "pliant/plate/energy/plastic_steps.hpp"
#include "pliant/plate/solver_errors.hpp"
#include "pliant/plate/step_loop.hpp"

namespace pliant {
namespace {

double dot(const Curvature& a, const Curvature& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace

// The plate of whole steps of backward Euler, where those of the plate itself are halves, and what
// is kept of its inverse.
struct TriangleContact {
  explicit TriangleContact(SolverChoice choice, const RunContext& context)
      : columns(context), problem(columns, context), whole(choice, context) {}

  InverseColumns columns;
  Complementarity problem;
  double shift = -1, drag = 0;  // of the columns; shift < 0: of none
  SparsePlate whole;
  bool is_assembled = false;  // `whole`

  // The matrix is another one.
  void forget() {
    columns.forget();
    problem.forget();
    shift = -1;
    is_assembled = false;
  }
};

TrianglePlate::TrianglePlate(TriangleCells cells, std::vector<double> masses, SolverChoice choice,
                             const RunContext& context, std::shared_ptr<const CellFactors> factors)
    : cells_(std::move(cells)),
      masses_(std::move(masses)),
      triangles_(triangles_of(cells_)),
      factors_(std::move(factors)),
      context_(context),
      solver_(choice),
      reduced_(cells_, static_cast<int>(masses_.size())),
      plate_(choice, context),
      plastic_share_(context.memory) {
  PLIANT_EXPECTS(static_cast<int>(masses_.size()) <= cells_.free_points);
}

TrianglePlate::~TrianglePlate() = default;

PlateWeights TrianglePlate::weights() const {
  PlateWeights weights;
  weights.areas =
      Eigen::Map<const Eigen::VectorXd>(masses_.data(), static_cast<Eigen::Index>(masses_.size()));
  weights.masses = weights.drags = weights.areas;
  for (int k = 0; factors_ && k < static_cast<int>(masses_.size()); ++k) {
    weights.masses[k] *= factor_at(factors_->density, k);
    weights.drags[k] *= factor_at(factors_->damping, k);
  }
  return weights;
}

Eigen::VectorXd TrianglePlate::goals() const {
  if (goal_ == 0) return {};
  Eigen::VectorXd goals(static_cast<Eigen::Index>(masses_.size()));
  for (int k = 0; k < static_cast<int>(masses_.size()); ++k)
    goals[k] = goal_ * (masses_[k] * (factors_ ? factor_at(factors_->goal, k) : 1));
  return goals;
}

template <class Real>
Result<Entries<Real>> TrianglePlate::entries_of() const {
  constexpr std::size_t parts_of_entry = 32;
  StopPoll poll(context_.should_stop);
  Entries<Real> entries;
  entries.reserve(reduced_.pairs);
  CellBlock<Real> block;
  for (int k = 0; k < cells_.block_count(); ++k) {
    block.compute(cells_, k, reduced_, bending_, factors_.get());
    if (poll.after(parts_of_entry * static_cast<std::size_t>(block.size() * block.size())))
      return interrupted();
    for (int a = block.inner_count(); a < block.size(); ++a) {
      for (int b = a; b < block.size(); ++b)
        entries.add(reduced_.places[block.unknown(a)], reduced_.places[block.unknown(b)],
                    block.at(a, b));
    }
  }
  return entries;
}

Result<void> TrianglePlate::bend(const Bending& bending, double goal) {
  if (is_bent_ && bending_ == bending && goal_ == goal) return {};
  bending_ = bending;
  goal_ = goal;
  if (contact_) contact_->forget();
  auto assembled = plate_.assemble(*this);
  is_bent_ = assembled.has_value();
  return assembled;
}

Result<SparseMatrix> TrianglePlate::stiffness(const Bending& bending, double goal) {
  if (auto bent = bend(bending, goal); !bent) return fail(bent.error());
  return plate_.stiffness();
}

// Eliminates the inner unknowns from forces on all unknowns. Errors: Interrupted.
Result<Field> TrianglePlate::reduced(const Field& forces) const {
  Field result(reduced_.count, 3);
  for (Eigen::Index unknown = 0; unknown < forces.rows(); ++unknown) {
    const int place = reduced_.places[unknown];
    if (place >= 0) result.row(place) = forces.row(unknown);
  }
  const auto presses_on_inner = [&](int block) {
    bool presses = false;
    for (int k = cells_.block_starts[block]; k < cells_.block_starts[block + 1]; ++k) {
      for_each_unknown(cells_, cells_.cells[k], [&](const CellUnknown& unknown) {
        presses =
            presses || (reduced_.places[unknown.index] < 0 && !forces.row(unknown.index).isZero(0));
      });
    }
    return presses;
  };
  CellBlock<double> block;
  std::vector<double> own;
  StopPoll poll(context_.should_stop);
  for (const int k : reduced_.blocks) {
    if (poll.after(200)) return interrupted();
    if (!presses_on_inner(k)) continue;
    block.compute(cells_, k, reduced_, bending_, factors_.get());
    for (int component = 0; component < 3; ++component) {
      own.assign(static_cast<std::size_t>(block.size()), 0);
      for (int n = 0; n < block.inner_count(); ++n) own[n] = forces(block.unknown(n), component);
      block.reduce(own);
      for (int n = block.inner_count(); n < block.size(); ++n) {
        result(reduced_.places[block.unknown(n)], component) += own[n];
      }
    }
  }
  return result;
}

Result<void> TrianglePlate::prepare(const Bending& bending, double shift, double goal) {
  if (auto bent = bend(bending, goal); !bent) return bent;
  return plate_.prepare(shift, 0);
}

// The forces on the unknowns by what is held: -K times the displacements and slopes that are given.
Field TrianglePlate::held_forces(const EdgeTangents& slopes, const Field& displacement) const {
  Field forces = Field::Zero(cells_.unknown_count(), 3);
  for (int number = 0; number < static_cast<int>(cells_.cells.size()); ++number) {
    const TriangleCell& each = cells_.cells[number];
    bool is_held = false;
    for (int k = 0; k < 3; ++k) {
      is_held = is_held || each.points[k] >= cells_.free_points || each.slopes[k].count == 0;
    }
    if (!is_held) continue;
    const Bending bending = bending_at(bending_, factors_.get(), number);
    const MorleyCell cell(each.shape);
    const std::array<Curvature, 6> by_value = cell.by_value();
    const PlaceCurvatures held = held_curvatures(cells_, each, cell, slopes, displacement);
    for (int component = 0; component < 3; ++component) {
      const Curvature h = {held[component], held[3 + component], held[6 + component]};
      if (h == Curvature{0, 0, 0}) continue;
      const Curvature moment = moments(bending, h);
      for_each_unknown(cells_, each, [&](const CellUnknown& unknown) {
        forces(unknown.index, component) -=
            cell.area * unknown.sign * dot(by_value[unknown.value], moment);
      });
    }
  }
  return forces;
}

Result<Field> TrianglePlate::solve(const Field& forces, Accuracy accuracy) {
  const auto points = static_cast<Eigen::Index>(masses_.size());
  PLIANT_EXPECTS(forces.rows() == points);
  Field right_hand_sides = Field::Zero(reduced_.count, 3);
  right_hand_sides.topRows(points) = forces;
  auto solution = accuracy == Accuracy::Refined ? plate_.solve(right_hand_sides)
                                                : plate_.solve_roughly(right_hand_sides);
  if (!solution) return solution;
  return Field(solution->topRows(points));
}

Result<PlateState> TrianglePlate::advance(const TriangleProblem& problem, const TimeSteps& steps,
                                          PlateState state) {
  const auto points = static_cast<Eigen::Index>(masses_.size());
  PLIANT_EXPECTS(state.displacement.rows() == cells_.point_count &&
                 state.velocity.rows() == points && problem.load.rows() == points);
  StageTimer set_up(context_.profile, Stage::SetUp);
  if (auto bent = bend(problem.bending, problem.goal); !bent) return fail(bent.error());
  if (auto ready = plate_.prepare(problem.dynamics, steps); !ready) return fail(ready.error());
  if (problem.law) {
    if (auto ready = prepare_plasticity(); !ready) return fail(ready.error());
  }
  set_up.stop();
  const StageTimer solving(context_.profile, Stage::Solve);
  Motion motion{state.displacement.topRows(points), std::move(state.velocity)};
  if (problem.law) {
    if (auto done = advance_plastic(problem, steps, state, motion); !done)
      return fail(done.error());
  } else {
    const auto forces_by = [&](const EdgeTangents& slopes, const Field& load) {
      auto sum = reduced(held_forces(slopes, state.displacement));
      if (sum) sum->topRows(points) += load;
      return sum;
    };
    auto last = forces_by(problem.tangents, problem.load);
    if (!last) return fail(last.error());
    ForceChange forces{{}, *std::move(last)};
    if (steps.are_exact()) {
      auto first = forces_by(problem.first_tangents, problem.first_load);
      if (!first) return fail(first.error());
      forces.first = *std::move(first);
    }
    if (problem.contact) {
      if (auto done = advance_with_contact(problem, steps, forces.last, motion); !done)
        return fail(done.error());
    } else {
      auto done = plate_.advance(problem.dynamics, steps, forces, motion);
      if (!done) return fail(done.error());
    }
  }
  state.displacement.topRows(points) = motion.displacement;
  state.velocity = std::move(motion.velocity);
  return state;
}

namespace {

SolvedMatrix contact_matrix(SparsePlate& plate, Eigen::Index size, const Eigen::VectorXd& shift) {
  const auto upper = [&plate, shift]() -> Result<SparseMatrix> {
    SparseMatrix matrix = plate.stiffness();
    for (Eigen::Index k = 0; k < shift.size(); ++k) matrix.coeffRef(k, k) += shift[k];
    return matrix;
  };
  return {size, [&plate](const Field& f) { return plate.solve_roughly(f); }, upper};
}

}  // namespace

// The plate for steps in which something touches: Newmark's need one of their own for these.
Result<SparsePlate*> TrianglePlate::prepare_contact(const Dynamics& dynamics,
                                                    const TimeSteps& steps) {
  if (!contact_) contact_ = std::make_unique<TriangleContact>(solver_, context_);
  const double dt = steps.length, shift = dynamics.shift(dt), drag = dynamics.damping / dt;
  SparsePlate& whole = steps.are_reflected() ? contact_->whole : plate_;
  if (steps.are_reflected() && !contact_->is_assembled) {
    if (auto assembled = whole.assemble(*this); !assembled) return fail(assembled.error());
    contact_->is_assembled = true;
  }
  if (auto ready = whole.prepare(shift, drag); !ready) return fail(ready.error());
  if (contact_->shift != shift || contact_->drag != drag) {
    contact_->columns.forget();
    contact_->problem.forget();
  }
  contact_->shift = shift;
  contact_->drag = drag;
  return &whole;
}

// Steps until something touches are those of a plate that meets nothing.
Result<void> TrianglePlate::advance_with_contact(const TriangleProblem& problem,
                                                 const TimeSteps& steps, const Field& forces,
                                                 Motion& motion) {
  StepContact& contact = *problem.contact;
  int number = 0;
  const bool is_reflected = steps.are_reflected();
  const auto touches_nothing = [&](const Field& solution) {
    const Field& w = motion.displacement;
    Field next = solution.topRows(w.rows());
    if (is_reflected) next = 2 * next - w;
    if (contact.begin(number, w, next)) return false;
    ++number;
    return true;
  };
  const auto gone = plate_.advance(problem.dynamics, steps, {{}, forces}, motion, touches_nothing);
  if (!gone) return fail(gone.error());
  if (*gone == steps.count) return {};
  const Dynamics& dynamics = problem.dynamics;
  const auto prepared = prepare_contact(dynamics, steps);
  if (!prepared) return fail(prepared.error());
  SparsePlate& whole = **prepared;
  const double dt = steps.length;
  const auto plate_of = [&](SparsePlate& plate, double length) {
    StepTerms terms = plate.terms(forces, dynamics, length);
    SolvedMatrix matrix = contact_matrix(plate, forces.rows(), terms.shift);
    return ContactPlate{[&plate](const Field& f) { return plate.solve(f); }, std::move(matrix),
                        std::move(terms), length};
  };
  const ContactPlate own = plate_of(whole, dt), half = plate_of(plate_, steps.solved_length());
  for (int step = *gone; step < steps.count; ++step) {
    if (context_.is_stopped()) return interrupted();
    if (is_reflected && step > *gone) {
      const auto stands = stands_without_contact(half, step, contact, motion);
      if (!stands) return fail(stands.error());
      if (*stands) continue;
    }
    if (auto stepped = step_with_contact(own, contact_->problem, step, contact, motion); !stepped)
      return stepped;
  }
  return {};
}

SolverCounts TrianglePlate::counts() const {
  return contact_ ? plate_.counts() + contact_->whole.counts() : plate_.counts();
}

std::size_t TrianglePlate::memory() const {
  const std::size_t of_contact =
      contact_ ? contact_->whole.memory() + contact_->columns.memory() : 0;
  return plate_.memory() + plastic_share_.bytes() + of_contact;
}

Result<void> TrianglePlate::prepare_plasticity() {
  if (plasticity_ && plasticity_->bending == bending_) return {};
  plasticity_.reset();
  StopPoll poll(context_.should_stop);
  plasticity_.emplace(Plasticity{bending_,
                                 {cells_, reduced_, bending_, factors_.get(), poll},
                                 {cells_, triangles_, bending_, factors_.get(), poll}});
  if (poll.after(0)) {
    plasticity_.reset();
    return interrupted();
  }
  const std::size_t bytes = plasticity_->inner.memory() + plasticity_->triangles.memory();
  if (plastic_share_.try_resize(bytes)) return {};
  plasticity_.reset();
  return fail(no_memory_to_solve(cells_.unknown_count(), plastic_share_.complaint(bytes)));
}

// All unknowns, those within blocks too, on which plastic curvatures press.
class TrianglePlate::FlowingTriangles final : public FlowingPlate {
 public:
  FlowingTriangles(TrianglePlate& plate, SparsePlate& solved)
      : plate_(plate), solved_(solved), triangles_(plate.plasticity_->triangles) {}

  Result<void> solve(const std::vector<int>&, const Field& forces, std::span<const UnknownRun>,
                     Field& solution) override {
    Field eliminated = forces;
    const InnerUnknowns& inner = plate_.plasticity_->inner;
    auto left = solved_.solve(inner.eliminate(eliminated));
    if (!left) return fail(left.error());
    solution = inner.recovered(*left, eliminated);
    return {};
  }

  Field forces_of(const PlasticField& plastic) override {
    Field forces = Field::Zero(plate_.cells_.unknown_count(), 3);
    triangles_.add_forces(plastic, forces);
    return forces;
  }

  std::vector<int> places_over(double part, const Field& x, const PlasticField& from) override {
    return triangles_.triangles_over(part, x, from);
  }

  PlaceRows rows_of(const std::vector<int>& places) override { return triangles_.rows_of(places); }

 private:
  TrianglePlate& plate_;
  SparsePlate& solved_;  // with the matrix of the steps
  const PlasticTriangles& triangles_;
};

// The steps are elastic until one yields.
Result<void> TrianglePlate::advance_plastic(const TriangleProblem& problem, const TimeSteps& steps,
                                            PlateState& state, Motion& motion) {
  const auto points = static_cast<Eigen::Index>(masses_.size());
  PLIANT_EXPECTS(state.plastic.rows() == static_cast<Eigen::Index>(triangles_.size()));
  InnerUnknowns& inner = plasticity_->inner;
  PlasticTriangles& triangles = plasticity_->triangles;
  std::vector<int> components = components_at_work(
      problem.tangents, problem.load, state.displacement, motion.velocity, state.plastic);
  triangles.set_law(*problem.law, factors_.get());
  triangles.hold(cells_, problem.tangents, state.displacement);
  Field known = held_forces(problem.tangents, state.displacement);
  Field forces = known;
  if (!state.plastic.isZero(0)) triangles.add_forces(state.plastic, forces);
  auto of_matrix = reduced(forces);
  if (!of_matrix) return fail(of_matrix.error());
  of_matrix->topRows(points) += problem.load;
  const Eigen::Index size = of_matrix->rows();
  known.topRows(points) += problem.load;
  inner.eliminate(forces);

  int number = 0;
  const auto stays_elastic = [&](const Field& solution) {
    if (triangles.yields(inner.recovered(solution, forces), state.plastic)) return false;
    if (!problem.contact) return true;
    const Field& w = motion.displacement;
    Field next = solution.topRows(w.rows());
    if (steps.are_reflected()) next = 2 * next - w;
    return !problem.contact->begin(number++, w, next);
  };
  const auto gone =
      plate_.advance(problem.dynamics, steps, {{}, *std::move(of_matrix)}, motion, stays_elastic);
  if (!gone) return fail(gone.error());
  if (*gone == steps.count) return {};
  const auto make = [&](SparsePlate& solved, const TimeSteps& own, std::vector<int> at_work,
                        const PlasticField& from) {
    StepTerms terms = solved.terms(known, problem.dynamics, own.solved_length());
    OwnedSteps made{std::make_unique<FlowingTriangles>(*this, solved), {}};
    if (problem.contact) made.matrix = contact_matrix(solved, size, terms.shift);
    made.steps = make_plastic_steps(*made.plate, context_, std::move(terms), problem.law->hardening,
                                    own, std::move(at_work), from);
    return made;
  };
  OwnedSteps all = make(plate_, steps, std::move(components), state.plastic);
  for (int step = *gone; step < steps.count; ++step) {
    const auto tried = try_step(*all.steps, step, problem.contact, motion, state.plastic);
    if (!tried) return fail(tried.error());
    if (tried->stands) continue;
    const auto whole = prepare_contact(problem.dynamics, steps);
    if (!whole) return fail(whole.error());
    const std::vector<int> every = {0, 1, 2};
    const MetPlate met{*problem.contact, contact_->problem,
                       [&](const PlasticField& from) -> Result<OwnedSteps> {
                         return make(plate_, steps, every, from);
                       },
                       [&](const PlasticField& from) -> Result<OwnedSteps> {
                         return make(**whole, {.count = steps.count, .length = steps.length}, every,
                                     from);
                       }};
    return run_met_steps(met, context_, steps, step, motion, state.plastic);
  }
  return {};
}

}  // namespace pliant
