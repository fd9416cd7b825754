#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/plate/outline/outline.hpp"
#include "pliant/plate/plate.hpp"

namespace pliant {

/// Factors by which the coefficients of a plate differ from node to node (#nodes of the outline's
/// grid); an empty one is 1 everywhere. docs/model.md, "Maps".
struct NodeFactors {
  std::vector<double> density, damping;
  std::vector<double> b, c, d;
  std::vector<double> yield, hardening;
  std::vector<double> goal;

  bool have_stiffness() const { return !b.empty() || !c.empty() || !d.empty(); }

  /// Whether an elastic plate has some of them.
  bool are_elastic() const {
    return have_stiffness() || !density.empty() || !damping.empty() || !goal.empty();
  }

  friend bool operator==(const NodeFactors&, const NodeFactors&) = default;
};

/// The factor at a node.
inline double factor_at(const std::vector<double>& factors, int node) {
  return factors.empty() ? 1 : factors[static_cast<std::size_t>(node)];
}

/// The system that a step solves: (shift I + L) w = f on the interior nodes of a clamped plate,
/// where L is that of `Stencil` with rim and tangents 0, and a goal on its diagonal. Symmetric, and
/// positive definite when the stiffness is elliptic and shift >= 0. docs/model.md, eq. (8).
///
/// With free edges or uneven material L is K of docs/model.md, "One energy", and the shift at a
/// node, and the goal, is weighted by its share of area. If no edge is clamped, K can be singular
/// without a shift.
struct PlateSystem {
  Outline outline;      ///< of at least 3 x 3 nodes
  Stiffness stiffness;  ///< elliptic
  double shift = 0;     ///< rho/dt^2 + eta/dt, >= 0 [1/uv^4]

  double poisson = 0;  ///< matters with free edges and uneven stiffness [1]
  std::shared_ptr<const NodeFactors> factors = {};  ///< null: the material is even
  double drag = 0;  ///< eta/dt, the part of `shift` that a map of damping changes [1/uv^4]
  double goal = 0;  ///< g >= 0, what pulls back to w = 0: a part of L [1/uv^4]

  /// Whether the edges, as far as they are no others, and the material are those of (1).
  bool is_even() const {
    return !(factors && factors->are_elastic()) && !outline.edges().have_free();
  }

  friend bool operator==(const PlateSystem& one, const PlateSystem& other);
};

/// One plate of a grid over one interval.
struct PlateProblem : PlateInterval {
  PlateProblem() = default;
  PlateProblem(Outline of, const Stiffness& stiff, const Dynamics& moving,
               const EdgeTangents& slopes = {}, Field loads = {}, double ratio = 0,
               std::shared_ptr<const NodeFactors> uneven = {})
      : PlateInterval{moving, slopes, std::move(loads)},
        outline(std::move(of)),
        stiffness(stiff),
        poisson(ratio),
        factors(std::move(uneven)) {}

  Outline outline;  ///< of at least 3 x 3 nodes
  Stiffness stiffness;

  double poisson = 0;                               ///< as in `PlateSystem`
  std::shared_ptr<const NodeFactors> factors = {};  ///< as there
  double goal = 0;                                  ///< as there

  /// Asked after each step with the displacement of all nodes (#nodes x 3); false: the steps that
  /// follow are not needed, and the result is not either. Null: nobody asks.
  const std::function<bool(const Field& displacement)>* watch = nullptr;

  bool is_even() const { return system(1).is_even(); }

  /// The system of steps of `dt`. [s]
  PlateSystem system(double dt) const {
    return {outline, stiffness, dynamics.shift(dt), poisson, factors, dynamics.damping / dt, goal};
  }
};

/// Whether the problem's load and the state have a row for each node.
inline bool is_on_nodes(const PlateProblem& problem, const PlateState& state) {
  const int nodes = problem.outline.grid().node_count();
  return problem.load.rows() == nodes && state.displacement.rows() == nodes &&
         state.velocity.rows() == nodes;
}

/// The state with other rows of the interior nodes; all other nodes have no velocity.
inline PlateState with_interior(const PlateProblem& problem, PlateState state,
                                const Field& displacement, const Field& velocity) {
  state.displacement = with_interior(problem.outline, std::move(state.displacement), displacement);
  state.velocity = with_interior(problem.outline, Field::Zero(problem.load.rows(), 3), velocity);
  return state;
}

}  // namespace pliant
