#include "pliant/plate/triangles/triangle_plate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/core/stage_timer.hpp"
#include "pliant/plate/energy/plastic_steps.hpp"
#include "pliant/plate/solver_errors.hpp"
#include "pliant/plate/step_loop.hpp"

namespace pliant {
namespace {

double dot(const Curvature& a, const Curvature& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace

TrianglePlate::TrianglePlate(TriangleCells cells, std::vector<double> masses, SolverChoice choice,
                             const RunContext& context, std::shared_ptr<const CellFactors> factors)
    : cells_(std::move(cells)),
      masses_(std::move(masses)),
      triangles_(triangles_of(cells_)),
      factors_(std::move(factors)),
      elastic_(factors_ && factors_->are_elastic() ? factors_.get() : nullptr),
      context_(context),
      solver_(choice),
      reduced_(cells_, static_cast<int>(masses_.size())),
      factor_(*this, choice, context),
      precise_share_(context.memory),
      motion_(context),
      plastic_share_(context.memory) {
  PLIANT_EXPECTS(static_cast<int>(masses_.size()) <= cells_.free_points);
}

Eigen::VectorXd TrianglePlate::weighted_masses() const {
  Eigen::VectorXd weighted(static_cast<Eigen::Index>(masses_.size()));
  for (Eigen::Index k = 0; k < weighted.size(); ++k) {
    const int point = static_cast<int>(k);
    weighted[k] = elastic_ ? masses_[k] * factor_at(elastic_->density, point) : masses_[k];
  }
  return weighted;
}

template <class Real>
Real TrianglePlate::shift_at(int point, double shift, double drag) const {
  if (!elastic_) return Real{shift} * masses_[point];
  return Real{masses_[point]} * (Real{shift - drag} * factor_at(elastic_->density, point) +
                                 Real{drag} * factor_at(elastic_->damping, point));
}

// Contributions are gathered by rows, in the order of the blocks, and those of one entry are added
// in that order.
template <class Real>
Result<TrianglePlate::Rows<Real>> TrianglePlate::rows(const Bending& bending, double shift,
                                                      double drag, Half half) const {
  constexpr std::size_t parts_of_entry = 32;
  StopPoll poll(context_.should_stop);
  struct Entry {
    int row, column;
    Real value;
  };
  std::vector<Entry> entries;
  CellBlock<Real> block;
  for (int k = 0; k < cells_.block_count(); ++k) {
    block.compute(cells_, k, reduced_, bending, factors_.get());
    if (poll.after(parts_of_entry * static_cast<std::size_t>(block.size() * block.size())))
      return interrupted();
    for (int a = block.inner_count(); a < block.size(); ++a) {
      for (int b = a; b < block.size(); ++b) {
        const auto [low, high] =
            std::minmax(reduced_.places[block.unknown(a)], reduced_.places[block.unknown(b)]);
        entries.push_back({high, low, block.at(a, b)});
        if (half == Half::Both && low != high) entries.push_back({low, high, block.at(a, b)});
      }
    }
  }
  const int size = reduced_.count;
  std::vector<int> starts(static_cast<std::size_t>(size) + 1, 0);
  for (const Entry& entry : entries) ++starts[entry.row + 1];
  for (int k = 0; k < size; ++k) starts[k + 1] += starts[k];
  std::vector<int> order(entries.size());
  std::vector<int> next(starts.begin(), starts.end() - 1);
  for (std::size_t k = 0; k < entries.size(); ++k) {
    order[next[entries[k].row]++] = static_cast<int>(k);
  }
  Rows<Real> rows;
  rows.columns.reserve(entries.size() / 2);
  rows.values.reserve(entries.size() / 2);
  for (int row = 0; row < size; ++row) {
    const auto begin = order.begin() + starts[row], end = order.begin() + starts[row + 1];
    if (poll.after(parts_of_entry * static_cast<std::size_t>(end - begin))) return interrupted();
    std::sort(begin, end, [&](int a, int b) {
      return std::pair(entries[a].column, a) < std::pair(entries[b].column, b);
    });
    for (auto place = begin; place != end;) {
      const int column = entries[*place].column;
      Real sum = 0;
      for (; place != end && entries[*place].column == column; ++place)
        sum += entries[*place].value;
      const bool has_mass = row == column && row < static_cast<int>(masses_.size());
      rows.columns.push_back(column);
      rows.values.push_back(has_mass ? sum + shift_at<Real>(row, shift, drag) : sum);
    }
    rows.starts.push_back(rows.columns.size());
  }
  return rows;
}

Result<SparseMatrix> TrianglePlate::matrix(const Bending& bending, double shift,
                                           double drag) const {
  // The rows of the lower half are the columns of the upper one.
  const auto made = rows<double>(bending, shift, drag, Half::Lower);
  if (!made) return fail(made.error());
  const Rows<double>& columns = *made;
  SparseMatrix matrix(reduced_.count, reduced_.count);
  matrix.reserve(static_cast<Eigen::Index>(columns.values.size()));
  for (int column = 0; column < reduced_.count; ++column) {
    matrix.startVec(column);
    for (std::size_t k = columns.starts[column]; k < columns.starts[column + 1]; ++k)
      matrix.insertBack(columns.columns[k], column) = columns.values[k];
  }
  matrix.finalize();
  return matrix;
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

Result<void> TrianglePlate::prepare(const Bending& bending, double shift, double drag) {
  if (is_factored_ && bending_ == bending && shift_ == shift && drag_ == drag) return {};
  const bool has_same_pattern = is_factored_;
  is_factored_ = false;
  bending_ = bending;
  shift_ = shift;
  drag_ = drag;
  // Errors are measured under an even pressure.
  const Eigen::Map<const Eigen::VectorXd> masses(masses_.data(),
                                                 static_cast<Eigen::Index>(masses_.size()));
  if (auto factored = factor_.factor(reduced_.count, has_same_pattern, masses); !factored)
    return factored;
  is_factored_ = true;
  return {};
}

// The forces on the unknowns by what is held: -K times the displacements and slopes that are given.
Field TrianglePlate::held_forces(const Bending& even, const GivenSlopes& slopes,
                                 const Field& displacement) const {
  Field forces = Field::Zero(cells_.unknown_count(), 3);
  for (int number = 0; number < static_cast<int>(cells_.cells.size()); ++number) {
    const TriangleCell& each = cells_.cells[number];
    bool is_held = false;
    for (int k = 0; k < 3; ++k) {
      is_held = is_held || each.points[k] >= cells_.free_points || each.slopes[k].count == 0;
    }
    if (!is_held) continue;
    const Bending bending = bending_at(even, factors_.get(), number);
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

Field TrianglePlate::residual(const Field& x, const Field& f) const {
  const double* const of_x = x.col(0).data();
  const double* const of_y = x.col(1).data();
  const double* const of_z = x.col(2).data();
  Field result(f.rows(), 3);
  for (Eigen::Index row = 0; row < result.rows(); ++row) {
    Extended left_x = f(row, 0);
    Extended left_y = f(row, 1);
    Extended left_z = f(row, 2);
    for (std::size_t k = precise_.starts[row]; k < precise_.starts[row + 1]; ++k) {
      const Extended entry = precise_.values[k];
      const int column = precise_.columns[k];
      left_x -= entry * of_x[column];
      left_y -= entry * of_y[column];
      left_z -= entry * of_z[column];
    }
    result(row, 0) = static_cast<double>(left_x);
    result(row, 1) = static_cast<double>(left_y);
    result(row, 2) = static_cast<double>(left_z);
  }
  return result;
}

Result<void> TrianglePlate::open(std::size_t entries) {
  // Both halves of the matrix, and twice as much while they are gathered.
  const std::size_t bytes = entries * 6 * (sizeof(Extended) + 2 * sizeof(int));
  if (!precise_share_.try_resize(bytes))
    return fail(factor_too_large(reduced_.count, precise_share_.complaint(bytes)));
  auto made = rows<Extended>(bending_, shift_, drag_, Half::Both);
  if (!made) return fail(made.error());
  precise_ = *std::move(made);
  return {};
}

void TrianglePlate::close() {
  precise_ = {};
  static_cast<void>(precise_share_.try_resize(0));  // to give back never fails
}

Result<Field> TrianglePlate::solve(const Field& forces) {
  const auto points = static_cast<Eigen::Index>(masses_.size());
  PLIANT_EXPECTS(is_factored_ && forces.rows() == points);
  Field right_hand_sides = Field::Zero(reduced_.count, 3);
  right_hand_sides.topRows(points) = forces;
  auto solution = factor_.solve(right_hand_sides);
  if (!solution) return solution;
  return Field(solution->topRows(points));
}

// The elastic steps of an interval, one after another.
class TrianglePlate::ElasticSteps {
 public:
  // `known`: the forces on the unknowns of the matrix, the load among them.
  ElasticSteps(TrianglePlate& plate, const Dynamics& dynamics, double dt, Field known)
      : plate_(plate),
        shift_(dynamics.shift(dt)),
        inertia_(dynamics.inertia(dt)),
        masses_(plate.masses_.data(), static_cast<Eigen::Index>(plate.masses_.size())),
        known_(std::move(known)),
        right_hand_sides_(known_) {
    plate_.factor_.begin_steps();
    if (!plate_.elastic_) return;
    const double drag = dynamics.damping / dt;
    inertias_ = inertia_ * plate_.weighted_masses();
    shifts_.resize(masses_.size());
    for (Eigen::Index k = 0; k < masses_.size(); ++k)
      shifts_[k] = plate_.shift_at<double>(static_cast<int>(k), shift_, drag);
  }

  Result<Field> solve(const Field& w, const Field& v) {
    const Eigen::Index points = masses_.size();
    for (int k = 0; plate_.elastic_ && k < 3; ++k) {
      right_hand_sides_.col(k).head(points) = known_.col(k).head(points) +
                                              shifts_.cwiseProduct(w.col(k)) +
                                              inertias_.cwiseProduct(v.col(k));
    }
    for (int k = 0; !plate_.elastic_ && k < 3; ++k) {
      right_hand_sides_.col(k).head(points) =
          known_.col(k).head(points) +
          masses_.cwiseProduct(shift_ * w.col(k) + inertia_ * v.col(k));
    }
    return plate_.factor_.solve_next(right_hand_sides_);
  }

  // With `known` on all unknowns.
  StepTerms terms(Field known) const {
    if (plate_.elastic_) return {std::move(known), shifts_, inertias_};
    return {std::move(known), shift_ * masses_, inertia_ * masses_};
  }

 private:
  TrianglePlate& plate_;
  double shift_, inertia_;
  Eigen::Map<const Eigen::VectorXd> masses_;
  Field known_, right_hand_sides_;
  Eigen::VectorXd shifts_, inertias_;  // of the points, if they differ by more than their masses
};

Result<TriangleState> TrianglePlate::advance(const TriangleProblem& problem, const TimeSteps& steps,
                                             TriangleState state) {
  const auto points = static_cast<Eigen::Index>(masses_.size());
  PLIANT_EXPECTS(state.displacement.rows() == cells_.point_count &&
                 state.velocity.rows() == points && problem.load.rows() == points);
  if (steps.are_exact()) return advance_exactly(problem, steps, std::move(state));
  const double dt = steps.solved_length();
  StageTimer set_up(context_.profile, Stage::SetUp);
  const double drag = elastic_ ? problem.dynamics.damping / dt : 0;
  if (auto ready = prepare(problem.bending, problem.dynamics.shift(dt), drag); !ready)
    return fail(ready.error());
  if (problem.law) {
    if (auto ready = prepare_plasticity(); !ready) return fail(ready.error());
  }
  set_up.stop();
  const StageTimer solving(context_.profile, Stage::Solve);
  if (problem.law) return advance_plastic(problem, steps, std::move(state));

  auto eliminated = reduced(held_forces(problem.bending, problem.slopes, state.displacement));
  if (!eliminated) return fail(eliminated.error());
  Field known = *std::move(eliminated);
  known.topRows(points) += problem.load;
  Motion motion{state.displacement.topRows(points), std::move(state.velocity)};
  ElasticSteps elastic(*this, problem.dynamics, dt, std::move(known));
  const auto solve = [&](const Field& w, const Field& v) { return elastic.solve(w, v); };
  if (auto done = run_steps(context_, steps, motion, solve); !done) return fail(done.error());
  state.displacement.topRows(points) = motion.displacement;
  state.velocity = std::move(motion.velocity);
  return state;
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
  explicit FlowingTriangles(TrianglePlate& plate)
      : plate_(plate), triangles_(plate.plasticity_->triangles) {}

  Result<void> solve(const std::vector<int>&, const Field& forces, Field& solution) override {
    Field eliminated = forces;
    const InnerUnknowns& inner = plate_.plasticity_->inner;
    auto left = plate_.factor_.solve(inner.eliminate(eliminated));
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
  const PlasticTriangles& triangles_;
};

// The steps are elastic until one yields.
Result<TriangleState> TrianglePlate::advance_plastic(const TriangleProblem& problem,
                                                     const TimeSteps& steps, TriangleState state) {
  const auto points = static_cast<Eigen::Index>(masses_.size());
  PLIANT_EXPECTS(state.plastic.rows() == static_cast<Eigen::Index>(triangles_.size()));
  InnerUnknowns& inner = plasticity_->inner;
  PlasticTriangles& triangles = plasticity_->triangles;
  std::vector<int> components = components_at_work(problem.slopes, problem.load, state.displacement,
                                                   state.velocity, state.plastic);
  triangles.set_law(*problem.law, factors_.get());
  triangles.hold(cells_, problem.slopes, state.displacement);
  Field known = held_forces(problem.bending, problem.slopes, state.displacement);
  Field forces = known;
  if (!state.plastic.isZero(0)) triangles.add_forces(state.plastic, forces);
  auto eliminated = reduced(forces);
  if (!eliminated) return fail(eliminated.error());
  Field of_matrix = *std::move(eliminated);
  of_matrix.topRows(points) += problem.load;
  known.topRows(points) += problem.load;
  inner.eliminate(forces);

  ElasticSteps elastic(*this, problem.dynamics, steps.solved_length(), std::move(of_matrix));
  Motion motion{state.displacement.topRows(points), std::move(state.velocity)};
  std::optional<Motion> before;  // the step that yields
  int done = 0;
  const auto solve = [&](const Field& w, const Field& v) {
    auto next = elastic.solve(w, v);
    if (next && triangles.yields(inner.recovered(*next, forces), state.plastic))
      before = Motion{w, v};
    return next;
  };
  const auto watch = [&](const Field&) {
    done += before ? 0 : 1;
    return !before;
  };
  if (auto ran = run_steps(context_, steps, motion, solve, watch); !ran) return fail(ran.error());
  if (before) {
    motion = *std::move(before);
    FlowingTriangles flowing(*this);
    const auto all =
        make_plastic_steps(flowing, context_, elastic.terms(std::move(known)),
                           problem.law->hardening, steps, std::move(components), state.plastic);
    auto ran = run_plastic_steps(*all, steps.count - done, motion, state.plastic);
    if (!ran) return fail(ran.error());
  }
  state.displacement.topRows(points) = motion.displacement;
  state.velocity = std::move(motion.velocity);
  return state;
}

Result<TriangleState> TrianglePlate::advance_exactly(const TriangleProblem& problem,
                                                     const TimeSteps& steps, TriangleState state) {
  const auto points = static_cast<Eigen::Index>(masses_.size());
  StageTimer set_up(context_.profile, Stage::SetUp);
  // What is reduced depends on it.
  if (!(bending_ == problem.bending)) is_factored_ = false;
  bending_ = problem.bending;
  std::vector<double> inertia = masses_, drag = masses_;
  for (int k = 0; k < static_cast<int>(masses_.size()); ++k) {
    inertia[k] *= problem.dynamics.density * (factors_ ? factor_at(factors_->density, k) : 1);
    drag[k] *= problem.dynamics.damping * (factors_ ? factor_at(factors_->damping, k) : 1);
  }
  auto stiffness = matrix(bending_, 0);
  if (!stiffness) return fail(stiffness.error());
  auto ready = motion_.prepare({*std::move(stiffness), std::move(inertia), std::move(drag)});
  if (!ready) return fail(ready.error());
  set_up.stop();
  const StageTimer solving(context_.profile, Stage::Solve);
  const auto force = [&](const GivenSlopes& slopes, const Field& load) {
    auto sum = reduced(held_forces(bending_, slopes, state.displacement));
    if (sum) sum->topRows(points) += load;
    return sum;
  };
  auto first = force(problem.first_slopes, problem.first_load);
  if (!first) return fail(first.error());
  auto last = force(problem.slopes, problem.load);
  if (!last) return fail(last.error());
  Field w = state.displacement.topRows(points);
  auto moved = motion_.advance(steps, {*std::move(first), *std::move(last)}, w, state.velocity);
  if (!moved) return fail(moved.error());
  state.displacement.topRows(points) = w;
  return state;
}

}  // namespace pliant
