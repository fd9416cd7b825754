#include "pliant/plate/energy/plate_energy.hpp"

#include <cmath>

namespace pliant {
namespace {

template <class Real>
SecondDifference<Real> difference_at(int line, int count, double spacing, bool is_closed,
                                     Edge first, Edge last) {
  const Real h = spacing;
  const Real unit = 1 / (h * h);
  if (is_closed || (line > 0 && line < count - 1)) return {unit, -2 * unit, unit};
  const bool is_first = line == 0;
  if ((is_first ? first : last) != Edge::Clamped) return {.is_eliminated = true};
  // The ghost beyond a clamped edge mirrors the node inside, plus the slope: eq. (6).
  if (is_first) return {0, -2 * unit, 2 * unit, -2 / h};
  return {2 * unit, -2 * unit, 0, 2 / h};
}

// b, c, d at a node.
Stiffness stiffness_at(const PlateSystem& system, int node) {
  const auto& [b, c, d] = system.stiffness;
  if (!system.factors) return system.stiffness;
  const NodeFactors& factors = *system.factors;
  return {b * factor_at(factors.b, node), c * factor_at(factors.c, node),
          d * factor_at(factors.d, node)};
}

}  // namespace

double PlateEnergy::share(int i, int j) const {
  const bool is_u = !grid().is_closed_u && (i == 0 || i == grid().columns - 1);
  const bool is_v = !grid().is_closed_v && (j == 0 || j == grid().rows - 1);
  return (is_u ? 0.5 : 1) * (is_v ? 0.5 : 1);
}

template <class Real>
SecondDifference<Real> PlateEnergy::along_u(int i) const {
  const Edges& edges = system_.outline.edges();
  return difference_at<Real>(i, grid().columns, grid().hu, grid().is_closed_u, edges.u0, edges.u1);
}

template <class Real>
SecondDifference<Real> PlateEnergy::along_v(int j) const {
  const Edges& edges = system_.outline.edges();
  return difference_at<Real>(j, grid().rows, grid().hv, grid().is_closed_v, edges.v0, edges.v1);
}

template <class Real>
Moduli<Real> PlateEnergy::moduli(int i, int j) const {
  const Stiffness stiffness = stiffness_at(system_, grid().node(i, j));
  const Real ratio = system_.poisson;
  const Real b = stiffness.b, d = stiffness.d;
  const Real coupling = ratio * std::sqrt(b * d);
  const Real twist = stiffness.c - 2 * coupling;
  const bool has_u = !along_u<double>(i).is_eliminated, has_v = !along_v<double>(j).is_eliminated;
  if (has_u && has_v) return {b, coupling, d, twist};
  // The energy least over the curvature that is eliminated.
  const Real rest = 1 - ratio * ratio;
  return {has_u ? rest * b : 0, 0, has_v ? rest * d : 0, twist};
}

template <class Real>
Real PlateEnergy::cell_modulus(int i, int j) const {
  const auto at = [&](int di, int dj) {
    const int node = grid().node_round(i + di, j + dj);
    return moduli<Real>(node % grid().columns, node / grid().columns).uv;
  };
  return (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)) / 4;
}

template <class Real>
StencilTable<Real> PlateEnergy::hessian() const {
  StencilTable<Real> table(grid());
  using Step = typename StencilTable<Real>::Step;
  for (int j = 0; j < grid().rows; ++j) {
    const auto v = along_v<Real>(j);
    for (int i = 0; i < grid().columns; ++i) {
      const auto u = along_u<Real>(i);
      const Moduli<Real> moduli = this->moduli<Real>(i, j);
      const Real area = share(i, j);
      const Step nodes[] = {{0, -1}, {-1, 0}, {0, 0}, {1, 0}, {0, 1}};
      const Real of_u[] = {0, u.before, u.here, u.after, 0};
      const Real of_v[] = {v.before, 0, v.here, 0, v.after};
      for (int p = 0; p < 5; ++p) {
        for (int q = p; q < 5; ++q) {
          const Real entry = moduli.uu * of_u[p] * of_u[q] + moduli.vv * of_v[p] * of_v[q] +
                             moduli.coupling * (of_u[p] * of_v[q] + of_v[p] * of_u[q]);
          if (entry != 0) table.add(i, j, nodes[p], nodes[q], area * entry);
        }
      }
    }
  }
  const Real hu = grid().hu, hv = grid().hv;
  const Real unit = 1 / (hu * hv * (hu * hv));
  for (int j = 0; j < cell_rows(); ++j) {
    for (int i = 0; i < cell_columns(); ++i) {
      const Real entry = cell_modulus<Real>(i, j) * unit;
      const Step nodes[] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
      const Real signs[] = {1, -1, -1, 1};
      for (int p = 0; p < 4; ++p) {
        for (int q = p; q < 4; ++q) {
          table.add(i, j, nodes[p], nodes[q], signs[p] * signs[q] * entry);
        }
      }
    }
  }
  return table;
}

void PlateEnergy::add_tangents(const EdgeTangents& tangents, Field& forces) const {
  if (tangents.are_zero()) return;
  for (int j = 0; j < grid().rows; ++j) {
    const auto v = along_v<double>(j);
    for (int i = 0; i < grid().columns; ++i) {
      const auto u = along_u<double>(i);
      if (u.slope == 0 && v.slope == 0) continue;
      const Vector3d of_u = u.slope * (i == 0 ? tangents.su0 : tangents.su1);
      const Vector3d of_v = v.slope * (j == 0 ? tangents.sv0 : tangents.sv1);
      const Moduli<double> moduli = this->moduli<double>(i, j);
      const double area = share(i, j);
      const Vector3d moment_u = area * (moduli.uu * of_u + moduli.coupling * of_v);
      const Vector3d moment_v = area * (moduli.coupling * of_u + moduli.vv * of_v);
      const auto add = [&](int di, int dj, double weight, const Vector3d& moment) {
        if (weight == 0) return;
        forces.row(grid().node_round(i + di, j + dj)) -= weight * moment.transpose();
      };
      add(-1, 0, u.before, moment_u);
      add(0, 0, u.here, moment_u);
      add(1, 0, u.after, moment_u);
      add(0, -1, v.before, moment_v);
      add(0, 0, v.here, moment_v);
      add(0, 1, v.after, moment_v);
    }
  }
}

Eigen::VectorXd node_masses(const PlateSystem& system) {
  const PlateEnergy energy(system);
  Eigen::VectorXd masses(unknown_count(system.outline));
  Eigen::Index unknown = 0;
  system.outline.for_each_run([&](const Outline::Run& run) {
    for (int i = run.i0; i <= run.i1; ++i) {
      const double share = energy.share(i, run.j);
      const int node = energy.grid().node(i, run.j);
      masses[unknown++] = share * (system.factors ? factor_at(system.factors->density, node) : 1);
    }
  });
  return masses;
}

template SecondDifference<double> PlateEnergy::along_u(int) const;
template SecondDifference<double> PlateEnergy::along_v(int) const;
template Moduli<double> PlateEnergy::moduli(int, int) const;
template StencilTable<double> PlateEnergy::hessian() const;
template StencilTable<long double> PlateEnergy::hessian() const;

}  // namespace pliant
