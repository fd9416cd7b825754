#include "pliant/plate/triangles/plastic_triangles.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace pliant {

std::vector<int> triangles_of(const TriangleCells& cells) {
  std::vector<int> triangles;
  triangles.reserve(cells.cells.size());
  for (const TriangleCell& cell : cells.cells) triangles.push_back(cell.triangle);
  std::sort(triangles.begin(), triangles.end());
  triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
  return triangles;
}

PlaceCurvatures held_curvatures(const TriangleCells& cells, const TriangleCell& cell,
                                const MorleyCell& shape, const EdgeTangents& slopes,
                                const Field& displacement) {
  const std::array<Curvature, 6> by_value = shape.by_value();
  PlaceCurvatures h = {};
  for (int component = 0; component < 3; ++component) {
    const auto add = [&](int value, double amount) {
      for (int n = 0; n < 3; ++n) h[3 * n + component] += amount * by_value[value][n];
    };
    const std::array<double, 4> given = {slopes.su0[component], slopes.su1[component],
                                         slopes.sv0[component], slopes.sv1[component]};
    for (int k = 0; k < 3; ++k) {
      if (cell.points[k] >= cells.free_points) add(k, displacement(cell.points[k], component));
      if (cell.slopes[k].count == 0) add(3 + k, shape.given_slope(k, given));
    }
  }
  return h;
}

PlasticTriangles::PlasticTriangles(const TriangleCells& cells, const std::vector<int>& triangles,
                                   const Bending& bending, const CellFactors* factors,
                                   StopPoll& poll)
    : areas_(triangles.size(), 0.0), cell_starts_(triangles.size() + 1, 0) {
  std::vector<int> place_of_cell;
  place_of_cell.reserve(cells.cells.size());
  for (const TriangleCell& cell : cells.cells) {
    if (poll.after(32)) return;
    const auto at = std::lower_bound(triangles.begin(), triangles.end(), cell.triangle);
    const int place = static_cast<int>(at - triangles.begin());
    place_of_cell.push_back(place);
    areas_[place] += MorleyCell(cell.shape).area;
    ++cell_starts_[place + 1];
  }
  std::partial_sum(cell_starts_.begin(), cell_starts_.end(), cell_starts_.begin());
  cells_.resize(cells.cells.size());
  std::vector<int> next(cell_starts_.begin(), cell_starts_.end() - 1);
  for (int cell = 0; cell < static_cast<int>(cells_.size()); ++cell)
    cells_[next[place_of_cell[cell]]++] = cell;
  for (int triangle = 0; triangle < count(); ++triangle) {
    if (poll.after(500)) return;
    for (int k = cell_starts_[triangle]; k < cell_starts_[triangle + 1]; ++k) {
      const TriangleCell& cell = cells.cells[cells_[k]];
      const MorleyCell shape(cell.shape);
      const std::array<Curvature, 6> by_value = shape.by_value();
      const double share = shape.area / areas_[triangle];
      for_each_unknown(cells, cell, [&](const CellUnknown& unknown) {
        const auto own =
            coefficients_.begin() + static_cast<std::ptrdiff_t>(coefficient_starts_.back());
        auto found = std::find_if(own, coefficients_.end(), [&](const Coefficient& other) {
          return other.unknown == unknown.index;
        });
        if (found == coefficients_.end())
          found = coefficients_.insert(found, {unknown.index, {0, 0, 0}});
        for (int n = 0; n < 3; ++n)
          found->by[n] += share * unknown.sign * by_value[unknown.value][n];
      });
    }
    coefficient_starts_.push_back(coefficients_.size());
    // All cells of a triangle have its coefficients.
    const Bending own = bending_at(bending, factors, cells_[cell_starts_[triangle]]);
    moduli_.push_back({own.uu, own.coupling, own.vv, own.uv});
  }
}

void PlasticTriangles::set_law(const PlasticLaw& law, const CellFactors* factors) {
  laws_.assign(areas_.size(), law);
  for (int k = 0; factors && k < count(); ++k) {
    laws_[k].yield *= factor_at(factors->yield, k);
    laws_[k].hardening *= factor_at(factors->hardening, k);
  }
}

void PlasticTriangles::hold(const TriangleCells& cells, const EdgeTangents& slopes,
                            const Field& displacement) {
  held_.setZero(count(), 9);
  for (int triangle = 0; triangle < count(); ++triangle) {
    for (int k = cell_starts_[triangle]; k < cell_starts_[triangle + 1]; ++k) {
      const TriangleCell& cell = cells.cells[cells_[k]];
      const MorleyCell shape(cell.shape);
      const double share = shape.area / areas_[triangle];
      const PlaceCurvatures h = held_curvatures(cells, cell, shape, slopes, displacement);
      for (int n = 0; n < 9; ++n) held_(triangle, n) += share * h[n];
    }
  }
}

// Of xi = k - (1 + H) k_p.
double PlasticTriangles::squared_stress(int triangle, const Field& x,
                                        const PlasticField& from) const {
  PlaceCurvatures xi;
  const double share = 1 + laws_[triangle].hardening;
  for (int k = 0; k < 9; ++k) xi[k] = held_(triangle, k) - share * from(triangle, k);
  for (const Coefficient& one : coefficients_of(triangle)) {
    for (int k = 0; k < 9; ++k) xi[k] += one.by[k / 3] * x(one.unknown, k % 3);
  }
  return product_of(moduli_[triangle], xi, xi);
}

std::vector<int> PlasticTriangles::triangles_over(double part, const Field& x,
                                                  const PlasticField& from) const {
  std::vector<int> triangles;
  for (int triangle = 0; triangle < count(); ++triangle) {
    const double yield = part * laws_[triangle].yield;
    if (squared_stress(triangle, x, from) > yield * yield) triangles.push_back(triangle);
  }
  return triangles;
}

bool PlasticTriangles::yields(const Field& x, const PlasticField& from) const {
  return !triangles_over(1, x, from).empty();
}

void PlasticTriangles::add_forces(const PlasticField& plastic, Field& forces) const {
  for (int triangle = 0; triangle < count(); ++triangle) {
    if (plastic.row(triangle).isZero(0)) continue;
    PlaceCurvatures own;
    for (int k = 0; k < 9; ++k) own[k] = areas_[triangle] * plastic(triangle, k);
    const PlaceCurvatures moments = moments_of(moduli_[triangle], own);
    for (const Coefficient& one : coefficients_of(triangle)) {
      for (int k = 0; k < 9; ++k) forces(one.unknown, k % 3) += one.by[k / 3] * moments[k];
    }
  }
}

PlaceRows PlasticTriangles::rows_of(const std::vector<int>& triangles) const {
  PlaceRows rows;
  for (const int triangle : triangles) {
    PlaceRows::Pattern pattern{moduli_[triangle], laws_[triangle], areas_[triangle], {}};
    for (const Coefficient& one : coefficients_of(triangle)) {
      rows.unknowns.push_back(one.unknown);
      pattern.by.push_back(one.by);
    }
    rows.pattern_of.push_back(static_cast<int>(rows.patterns.size()));
    rows.patterns.push_back(std::move(pattern));
    rows.starts.push_back(rows.unknowns.size());
    PlaceCurvatures& held = rows.held.emplace_back();
    for (int k = 0; k < 9; ++k) held[k] = held_(triangle, k);
  }
  return rows;
}

std::size_t PlasticTriangles::memory() const {
  return coefficients_.size() * sizeof(Coefficient) + cells_.size() * sizeof(int) +
         areas_.size() * (2 * sizeof(int) + sizeof(double) + sizeof(Moduli<double>) +
                          sizeof(PlasticLaw) + sizeof(std::size_t) + 9 * sizeof(double));
}

}  // namespace pliant
