#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "pliant/plate/contact/contact_steps.hpp"
#include "pliant/plate/energy/place_curvatures.hpp"
#include "pliant/plate/plate_solver.hpp"
#include "pliant/plate/step_loop.hpp"

namespace pliant {

/// Places of a plate, nodes of a grid or triangles, and how their curvatures depend on its
/// unknowns.
struct PlaceRows {
  /// What places may share: their material, and the change of k_uu, k_vv and k_uv for a
  /// displacement of 1 of each unknown they depend on.
  struct Pattern {
    Moduli<double> form;
    PlasticLaw law;
    double area = 0;
    std::vector<std::array<double, 3>> by;
  };

  std::vector<Pattern> patterns;
  std::vector<int> pattern_of;            ///< of each place
  std::vector<std::size_t> starts = {0};  ///< #places + 1: the first of each in `unknowns`
  std::vector<int> unknowns;              ///< as its pattern has them; -1: held
  std::vector<PlaceCurvatures> held;      ///< of each place, by what is held and prescribed
};

/// A plate that flows, on a grid or on triangles, as its steps see it. Fields of displacements x
/// and of forces are on the unknowns (#unknowns x 3), of which the first ones move. With A the
/// matrix of the elastic step and f(x) the forces of what x makes flow, a step solves
/// A x = right-hand side + f(x), eq. (8k). A is only solved. Internal to plate.
class FlowingPlate {
 public:
  virtual ~FlowingPlate() = default;

  /// A^-1 forces of these components; other forces are 0. The others of the solution are left. If
  /// there are `runs`, forces are 0 outside, and the solution may be left there.
  virtual Result<void> solve(const std::vector<int>& components, const Field& forces,
                             std::span<const UnknownRun> runs, Field& solution) = 0;

  /// The forces of plastic curvatures, sum of omega B^T C k_p.
  virtual Field forces_of(const PlasticField& plastic) = 0;

  /// The places, ascending, whose stress is over `part` of the yield stress with `from`.
  virtual std::vector<int> places_over(double part, const Field& x, const PlasticField& from) = 0;

  /// Those places in detail; ascending.
  virtual PlaceRows rows_of(const std::vector<int>& places) = 0;
};

/// What a plate that flows meets, and how its forces are found.
struct PlasticContact {
  StepContact& contact;
  Complementarity& problem;
  const SolvedMatrix& matrix;  ///< of a step of backward Euler
};

/// The steps of an interval, each of displacement and plastic curvatures together, to 1e-9 of the
/// peak. Steps learn from those before them. Internal to plate.
class PlasticSteps {
 public:
  virtual ~PlasticSteps() = default;

  /// Lets the next step begin with what flows at `x`, which is near its solution; the last one may
  /// come near `end`.
  virtual void expect(const Field& x, const Field& end, const PlasticField& plastic) = 0;

  /// One step; whether a place flowed in it. Errors: those of the plate; SolverFailed if the step
  /// does not settle; Interrupted.
  virtual Result<bool> step(Motion& motion, PlasticField& plastic) = 0;

  /// Step `number` of its interval, in which displacement, plastic curvatures and the forces of
  /// contact fit together. Requires: steps of backward Euler, all components at work. Errors: as
  /// `step`, and those of contact.
  virtual Result<void> meet(int number, const PlasticContact& with, Motion& motion,
                            PlasticField& plastic) = 0;
};

/// The components of a plate that do not stay 0: all but those in which all of these are 0, on what
/// is held too. Where the forces of what is held cancel on the unknowns, its curvatures do not, and
/// flow belongs to all components of a place together.
std::vector<int> components_at_work(const EdgeTangents& tangents, const Field& load,
                                    const Field& displacement, const Field& velocity,
                                    const PlasticField& plastic);

/// `terms.known` is without the plastic curvatures; `plastic` are those before the first step.
/// Refers to `plate` and `context`.
std::unique_ptr<PlasticSteps> make_plastic_steps(FlowingPlate& plate, const RunContext& context,
                                                 StepTerms terms, double hardening,
                                                 const TimeSteps& steps,
                                                 std::vector<int> components,
                                                 const PlasticField& plastic);

/// Steps with the plate that they refer to.
struct OwnedSteps {
  std::unique_ptr<FlowingPlate> plate;
  std::unique_ptr<PlasticSteps> steps;
  SolvedMatrix matrix = {};  ///< of a step; set if the plate meets solids
};

/// What became of a step.
struct TriedStep {
  bool stands = true;  ///< false: something touches in it, and nothing has changed
  bool flowed = false;
};

/// Step `number` of its interval; `contact` null: there is nothing to touch. Errors: those of a
/// step.
Result<TriedStep> try_step(PlasticSteps& steps, int number, StepContact* contact, Motion& motion,
                           PlasticField& plastic);

/// How the steps of a plate that meets solids are made, with all components at work, and the
/// plastic curvatures before the first.
struct MetPlate {
  StepContact& contact;
  Complementarity& problem;
  std::function<Result<OwnedSteps>(const PlasticField&)> make_tried;  ///< of Newmark's
  std::function<Result<OwnedSteps>(const PlasticField&)> make_whole;  ///< of backward Euler
};

/// Runs the steps from `first` on, in which something touches. One of Newmark's in which something
/// touches is one of backward Euler. Errors: those of a step.
Result<void> run_met_steps(const MetPlate& plate, const RunContext& context, const TimeSteps& steps,
                           int first, Motion& motion, PlasticField& plastic);

}  // namespace pliant
