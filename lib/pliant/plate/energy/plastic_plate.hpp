#pragma once

#include <memory>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/plate/energy/plate_energy.hpp"
#include "pliant/plate/energy/return_mapping.hpp"

namespace pliant {

/// The curvatures of a plate on the nodes of a rectangle, and how they flow. docs/model.md,
/// "Plasticity". Internal to plate. Source: Simo & Hughes, Computational Inelasticity (1998).
class PlasticPlate {
 public:
  /// Requires: problem.law.
  explicit PlasticPlate(const PlateProblem& problem);

  /// Whether a node is over its yield stress with displacement `w` and plastic curvatures `from`
  /// (#nodes x 3, x 9).
  bool yields(const Field& w, const PlasticField& from) const;

  /// The plastic curvatures that `w` makes of `from`: the return mapping, eq. (8j). Remembers the
  /// nodes that flow, for `add_slope`. Returns whether there are any.
  bool flow(const Field& w, const PlasticField& from, PlasticField& to);

  /// Adds the forces of plastic curvatures to those on the nodes: sum of omega B^T C k, eq. (8k).
  void add_forces(const PlasticField& plastic, Field& forces) const;

  /// Adds how these forces change with the displacement, in the direction `way` (#nodes x 3), at
  /// the last `flow`.
  void add_slope(const Field& way, Field& forces) const;

 private:
  // A node with its neighbours, counted round, and the weights of its curvatures.
  struct Stencil {
    int node;
    int left, right, below, above;  // the node itself where a weight is 0
    int corners[4];                 // (-,-), (+,-), (-,+), (+,+); on an edge, nearer ones
    SecondDifference<double> u, v;
    double twist;  // the weight of the corners
    double area;
  };

  struct Flowing {
    int i, j;
    Flow flow;
  };

  Stencil stencil(int i, int j) const;
  PlaceCurvatures curvatures(const Stencil& at, const Field& w) const;
  void add_forces(const Stencil& at, const PlaceCurvatures& plastic, Field& forces) const;
  PlaceCurvatures stress(int i, int j, const Field& w, const PlasticField& from) const;
  double squared_norm(int node, const PlaceCurvatures& xi) const;
  PlasticLaw law(int node) const;

  Grid grid_;
  PlasticLaw law_;
  std::shared_ptr<const NodeFactors> factors_;
  EdgeTangents tangents_;
  std::vector<SecondDifference<double>> along_u_, along_v_;  // of columns, of rows
  std::vector<Moduli<double>> moduli_;                       // of nodes
  std::vector<Flowing> flowing_;
};

}  // namespace pliant
