#pragma once

#include <memory>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/plate/energy/plastic_steps.hpp"
#include "pliant/plate/energy/plate_energy.hpp"
#include "pliant/plate/kernels/kernels.hpp"

namespace pliant {

/// The curvatures of a plate on the nodes of a rectangle, and where they yield. docs/model.md,
/// "Plasticity". Internal to plate. Source: Simo & Hughes, Computational Inelasticity (1998).
class PlasticPlate {
 public:
  /// Requires: problem.law.
  PlasticPlate(const PlateProblem& problem, std::vector<int> components,
               const PlateKernels& kernels);

  /// The components that are not 0 all the time.
  const std::vector<int>& components() const { return components_; }

  /// The nodes, ascending, whose stress is over `part` of their yield stress with displacement `w`
  /// and plastic curvatures `from` (#nodes x 3, x 9).
  std::vector<int> nodes_over(double part, const Field& w, const PlasticField& from) const;

  /// Whether there are any.
  bool yields(const Field& w, const PlasticField& from) const;

  /// Adds the forces of plastic curvatures to those on the nodes: sum of omega B^T C k, eq. (8k).
  void add_forces(const PlasticField& plastic, Field& forces) const;

  /// How the curvatures of `nodes` depend on the unknowns, whose `numbers` (#nodes) are -1 where
  /// `w` is held.
  PlaceRows rows_of(const std::vector<int>& nodes, const std::vector<int>& numbers,
                    const Field& w) const;

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

  Stencil stencil(int i, int j) const;
  PlaceCurvatures curvatures(const Stencil& at, const Field& w) const;
  PlaceCurvatures by_tangents(int i, int j) const;
  PlaceCurvatures stress(int i, int j, const Field& w, const PlasticField& from) const;
  double squared_stress(int i, int j, const Field& w, const PlasticField& from) const;
  void find_squared_stress(int j, const Field& w, const PlasticField& from,
                           std::vector<double>& squared) const;
  template <class F>
  void for_each_over(double part, const Field& w, const PlasticField& from, const F& f) const;
  const Moduli<double>& form(int i, int j) const;
  PlasticLaw law(int node) const;

  const PlateKernels& kernels_;
  Grid grid_;
  PlasticLaw law_;
  std::shared_ptr<const NodeFactors> factors_;
  EdgeTangents tangents_;
  std::vector<SecondDifference<double>> along_u_, along_v_;  // of columns, of rows
  // Of nodes, if the material differs; otherwise of the first, the inner and the last of a row, for
  // the first row, the inner ones and the last.
  std::vector<Moduli<double>> forms_;
  std::vector<int> components_;
};

}  // namespace pliant
