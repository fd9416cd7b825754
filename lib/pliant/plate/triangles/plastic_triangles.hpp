#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/plate/energy/plastic_steps.hpp"
#include "pliant/plate/triangles/cell_factors.hpp"

namespace pliant {

/// The triangles of the surface that a plate has a part of, ascending; of a plate's plastic
/// curvatures and of `CellFactors::yield` and `hardening`, row k is that of triangle k here.
std::vector<int> triangles_of(const TriangleCells& cells);

/// The curvatures of a cell by what is held: its displacements, and the slopes that are given.
PlaceCurvatures held_curvatures(const TriangleCells& cells, const TriangleCell& cell,
                                const MorleyCell& shape, const EdgeTangents& slopes,
                                const Field& displacement);

/// The curvatures of a plate's triangles, and how they flow. That of a triangle is the mean over
/// its cells by area; its area is theirs. docs/model.md, "Plasticity" and "Surfaces". Internal to
/// plate.
class PlasticTriangles {
 public:
  /// `factors` null: the material is even. Unfinished if it is stopped.
  PlasticTriangles(const TriangleCells& cells, const std::vector<int>& triangles,
                   const Bending& bending, const CellFactors* factors, StopPoll& poll);

  void set_law(const PlasticLaw& law, const CellFactors* factors);

  /// What is held until the next call. `displacement` is #points x 3.
  void hold(const TriangleCells& cells, const EdgeTangents& slopes, const Field& displacement);

  /// As those of `PlasticPlate`. Displacements (with slopes) and forces are on all unknowns.
  std::vector<int> triangles_over(double part, const Field& x, const PlasticField& from) const;
  bool yields(const Field& x, const PlasticField& from) const;
  void add_forces(const PlasticField& plastic, Field& forces) const;
  PlaceRows rows_of(const std::vector<int>& triangles) const;

  std::size_t memory() const;

 private:
  // How the curvature of a triangle depends on an unknown.
  struct Coefficient {
    int unknown;
    Curvature by;
  };

  int count() const { return static_cast<int>(areas_.size()); }
  std::span<const Coefficient> coefficients_of(int triangle) const {
    const std::size_t first = coefficient_starts_[triangle];
    return std::span(coefficients_).subspan(first, coefficient_starts_[triangle + 1] - first);
  }
  double squared_stress(int triangle, const Field& x, const PlasticField& from) const;

  std::vector<double> areas_;             // [length^2]
  std::vector<Moduli<double>> moduli_;    // [b length^4/uv^4]
  std::vector<PlasticLaw> laws_;          // one, or one for each
  std::vector<int> cell_starts_, cells_;  // of each triangle
  std::vector<std::size_t> coefficient_starts_ = {0};
  std::vector<Coefficient> coefficients_;
  PlasticField held_;  // by what is held [1/length]
};

}  // namespace pliant
