#include "pliant/plate/energy/grid_assembly.hpp"

#include <algorithm>
#include <numbers>
#include <utility>

#include "pliant/plate/energy/plate_energy.hpp"
#include "pliant/plate/rim_load.hpp"
#include "pliant/plate/stencil.hpp"

namespace pliant {
namespace {

// The stencil of an even plate with clamped edges, between interior nodes. Eq. (4), (5), (7).
template <class Real>
StencilTable<Real> stencil_table(const PlateSystem& system) {
  const Outline& outline = system.outline;
  StencilTable<Real> table(outline.grid());
  const Stencil<Real> stencil(outline.grid(), system.stiffness);
  outline.for_each_run([&](const Outline::Run& run) {
    const int j = run.j;
    for (int i = run.i0; i <= run.i1; ++i) {
      const auto holds = [&](int di, int dj) { return outline.holds(i + di, j + dj); };
      const int ghosts_u = !holds(-1, 0) + !holds(1, 0), ghosts_v = !holds(0, -1) + !holds(0, 1);
      table.add(i, j, {0, 0}, {0, 0},
                6 * stencil.b + 4 * stencil.c + 6 * stencil.d + ghosts_u * stencil.b +
                    ghosts_v * stencil.d);
      const auto add = [&](int di, int dj, Real weight) {
        if (holds(di, dj)) table.add(i, j, {0, 0}, {di, dj}, weight);
      };
      add(1, 0, -4 * stencil.b - 2 * stencil.c);
      add(0, 1, -2 * stencil.c - 4 * stencil.d);
      add(-1, 1, stencil.c);
      add(1, 1, stencil.c);
      if (holds(1, 0)) add(2, 0, stencil.b);
      if (holds(0, 1)) add(0, 2, stencil.d);
    }
  });
  return table;
}

}  // namespace

GridAssembly::GridAssembly(const PlateSystem& system)
    : system_(unshifted(system)), numbers_(numbers_of_unknowns(system.outline)) {}

PlateSystem GridAssembly::unshifted(PlateSystem system) {
  system.shift = system.drag = 0;
  return system;
}

// A mask has clamped edges, and its material is even but for density and damping. Around held nodes
// slopes are free.
bool GridAssembly::is_stencil() const {
  if (system_.outline.has_held_nodes()) return false;
  const bool is_even = !(system_.factors && system_.factors->have_stiffness());
  return !system_.outline.mask().empty() || (is_even && system_.outline.edges().are_clamped());
}

PlateWeights GridAssembly::weights() const {
  PlateWeights weights;
  weights.masses = node_masses(system_);
  weights.areas.resize(size());
  weights.drags.resize(size());
  const PlateEnergy energy(system_);
  Eigen::Index unknown = 0;
  system_.outline.for_each_run([&](const Outline::Run& run) {
    for (int i = run.i0; i <= run.i1; ++i, ++unknown) {
      const int node = energy.grid().node(i, run.j);
      const double share = energy.share(i, run.j);
      weights.areas[unknown] = share;
      weights.drags[unknown] =
          share * (system_.factors ? factor_at(system_.factors->damping, node) : 1);
    }
  });
  return weights;
}

Eigen::VectorXd GridAssembly::goals() const {
  if (system_.goal == 0) return {};
  Eigen::VectorXd goals(size());
  const PlateEnergy energy(system_);
  Eigen::Index unknown = 0;
  system_.outline.for_each_run([&](const Outline::Run& run) {
    for (int i = run.i0; i <= run.i1; ++i) {
      const double factor =
          system_.factors ? factor_at(system_.factors->goal, energy.grid().node(i, run.j)) : 1;
      goals[unknown++] = system_.goal * (energy.share(i, run.j) * factor);
    }
  });
  return goals;
}

std::size_t GridAssembly::most_entries() const {
  return StencilTable<double>::steps.size() * static_cast<std::size_t>(size());
}

template <class Real>
StencilTable<Real> GridAssembly::table() const {
  return is_stencil() ? stencil_table<Real>(system_) : PlateEnergy(system_).hessian<Real>();
}

template <class Real>
Entries<Real> GridAssembly::entries_of() const {
  Entries<Real> entries;
  entries.reserve(most_entries());
  table<Real>().for_each([&](int node, int other, Real value) {
    const int one = numbers_[node], two = numbers_[other];
    if (one >= 0 && two >= 0) entries.add(one, two, value);
  });
  return entries;
}

Result<Entries<double>> GridAssembly::entries() const { return entries_of<double>(); }
Result<Entries<long double>> GridAssembly::precise_entries() const {
  return entries_of<long double>();
}

// By the differences of the stencil.
Field GridAssembly::residual(const Eigen::VectorXd& shifts, const Field& x, const Field& f) const {
  using Real = long double;
  const Outline& outline = system_.outline;
  const Grid& grid = outline.grid();
  const Stencil<Real> stencil(grid, system_.stiffness);
  Field result(f.rows(), 3);
  std::vector<Real> nodes(static_cast<std::size_t>(grid.node_count()));  // the rim remains 0
  with_steps(outline, [&](const auto& steps_at) {
    for (int component = 0; component < 3; ++component) {
      int row = 0;
      outline.for_each_run([&](const Outline::Run& run) {
        for (int i = run.i0; i <= run.i1; ++i) nodes[grid.node(i, run.j)] = x(row++, component);
      });
      row = 0;
      outline.for_each_run([&](const Outline::Run& run) {
        for (int i = run.i0; i <= run.i1; ++i, ++row) {
          const auto steps = steps_at(i, run.j);
          const Real* const p = &nodes[grid.node(i, run.j)];
          const auto near = [&](int di, int dj) { return p[steps.to(di, dj)]; };
          const auto far = [&](int di, int dj) {
            return is_ghost(outline, i, run.j, di, dj) ? p[0] : near(di, dj);
          };
          const Real product = shifts[row] * p[0] + stencil.apply(near, far);
          result(row, component) = static_cast<double>(f(row, component) - product);
        }
      });
    }
  });
  return result;
}

// A factorisation leaves a relative error of up to condition x eps: that of a static plate of 401 x
// 401 is 1e-8.
bool GridAssembly::loses_digits(double shift) const {
  constexpr double most = 1e7;
  PlateSystem system = system_;
  // A goal with a map may be 0 somewhere.
  const bool is_everywhere = !(system_.factors && !system_.factors->goal.empty());
  system.shift = is_everywhere ? shift + system_.goal : shift;
  return is_stencil() && !(estimate_condition(system) < most);
}

Field GridAssembly::forces(const Field& load, const EdgeTangents& tangents,
                           const Field& displacement) const {
  const Outline& outline = system_.outline;
  Field forces = load;
  if (is_stencil()) {
    subtract_rim(outline, system_.stiffness, tangents, displacement, forces);
    return interior_of(outline, forces);
  }
  const PlateEnergy energy(system_);
  Field rim = displacement;
  outline.for_each_run([&](const Outline::Run& run) {
    for (int i = run.i0; i <= run.i1; ++i) {
      const int node = outline.grid().node(i, run.j);
      rim.row(node).setZero();
      forces.row(node) *= energy.share(i, run.j);
    }
  });
  if (!rim.isZero(0)) {
    table<double>().for_each([&](int node, int other, double entry) {
      forces.row(node) -= entry * rim.row(other);
      if (other != node) forces.row(other) -= entry * rim.row(node);
    });
  }
  energy.add_tangents(tangents, forces);
  return interior_of(outline, forces);
}

double estimate_condition(const PlateSystem& system) {
  const auto& [b, c, d] = system.stiffness;
  const Grid& grid = system.outline.grid();
  const double width = (grid.columns - 1) * grid.hu;
  const double depth = (grid.rows - 1) * grid.hv;
  // (1 -2 1)/h^2 has eigenvalues from about (pi/extent)^2, round a ring from 0, to 4/h^2.
  const double most_u = 4 / (grid.hu * grid.hu);
  const double most_v = 4 / (grid.hv * grid.hv);
  const double pi_squared = std::numbers::pi * std::numbers::pi;
  const double least_u = grid.is_closed_u ? 0 : pi_squared / (width * width);
  const double least_v = grid.is_closed_v ? 0 : pi_squared / (depth * depth);
  const double most =
      system.shift + b * most_u * most_u + std::max(c, 0.0) * most_u * most_v + d * most_v * most_v;
  const double least = b * least_u * least_u + c * least_u * least_v + d * least_v * least_v;
  return std::max(1.0, most / (system.shift + least));
}

}  // namespace pliant
