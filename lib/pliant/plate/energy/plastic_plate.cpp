#include "pliant/plate/energy/plastic_plate.hpp"

#include "pliant/core/expects.hpp"

namespace pliant {

PlasticPlate::PlasticPlate(const PlateProblem& problem)
    : grid_(problem.outline.grid()), factors_(problem.factors), tangents_(problem.tangents) {
  PLIANT_EXPECTS(problem.law.has_value());
  law_ = *problem.law;
  const PlateSystem system = problem.system(1);
  const PlateEnergy energy(system);
  for (int i = 0; i < grid_.columns; ++i) along_u_.push_back(energy.along_u<double>(i));
  for (int j = 0; j < grid_.rows; ++j) along_v_.push_back(energy.along_v<double>(j));
  moduli_.reserve(static_cast<std::size_t>(grid_.node_count()));
  for (int j = 0; j < grid_.rows; ++j) {
    for (int i = 0; i < grid_.columns; ++i) moduli_.push_back(energy.moduli<double>(i, j));
  }
}

PlasticLaw PlasticPlate::law(int node) const {
  if (!factors_) return law_;
  return {law_.yield * factor_at(factors_->yield, node),
          law_.hardening * factor_at(factors_->hardening, node)};
}

PlasticPlate::Stencil PlasticPlate::stencil(int i, int j) const {
  Stencil at;
  at.node = grid_.node(i, j);
  at.u = along_u_[static_cast<std::size_t>(i)];
  at.v = along_v_[static_cast<std::size_t>(j)];
  const auto beside = [](int line, int count, bool is_closed) {
    struct Sides {
      int before, after;
    };
    if (is_closed) return Sides{(line + count - 1) % count, (line + 1) % count};
    return Sides{line > 0 ? line - 1 : line, line < count - 1 ? line + 1 : line};
  };
  const auto [i0, i1] = beside(i, grid_.columns, grid_.is_closed_u);
  const auto [j0, j1] = beside(j, grid_.rows, grid_.is_closed_v);
  at.left = grid_.node(i0, j);
  at.right = grid_.node(i1, j);
  at.below = grid_.node(i, j0);
  at.above = grid_.node(i, j1);
  // The mean over the cells around the node: inner differences cancel.
  at.corners[0] = grid_.node(i0, j0);
  at.corners[1] = grid_.node(i1, j0);
  at.corners[2] = grid_.node(i0, j1);
  at.corners[3] = grid_.node(i1, j1);
  const int wide = (i0 != i) + (i1 != i), high = (j0 != j) + (j1 != j);
  at.twist = 1 / (grid_.hu * grid_.hv * wide * high);
  at.area = 0.25 * wide * high;
  return at;
}

PlaceCurvatures PlasticPlate::curvatures(const Stencil& at, const Field& w) const {
  PlaceCurvatures result;
  for (int k = 0; k < 3; ++k) {
    const double* const of = w.col(k).data();
    const double here = of[at.node];
    result[k] = at.u.before * of[at.left] + at.u.here * here + at.u.after * of[at.right];
    result[3 + k] = at.v.before * of[at.below] + at.v.here * here + at.v.after * of[at.above];
    result[6 + k] = at.twist * ((of[at.corners[3]] - of[at.corners[2]]) -
                                (of[at.corners[1]] - of[at.corners[0]]));
  }
  return result;
}

void PlasticPlate::add_forces(const Stencil& at, const PlaceCurvatures& plastic,
                              Field& forces) const {
  const PlaceCurvatures moments = moments_of(moduli_[static_cast<std::size_t>(at.node)], plastic);
  for (int k = 0; k < 3; ++k) {
    double* const to = forces.col(k).data();
    const double of_u = at.area * moments[k], of_v = at.area * moments[3 + k];
    const double twist = at.area * at.twist * moments[6 + k];
    to[at.left] += at.u.before * of_u;
    to[at.right] += at.u.after * of_u;
    to[at.below] += at.v.before * of_v;
    to[at.above] += at.v.after * of_v;
    to[at.node] += at.u.here * of_u + at.v.here * of_v;
    to[at.corners[0]] += twist;
    to[at.corners[1]] -= twist;
    to[at.corners[2]] -= twist;
    to[at.corners[3]] += twist;
  }
}

// xi = k - (1 + H) k_p.
PlaceCurvatures PlasticPlate::stress(int i, int j, const Field& w, const PlasticField& from) const {
  const Stencil at = stencil(i, j);
  PlaceCurvatures result = curvatures(at, w);
  if (at.u.slope != 0 || at.v.slope != 0) {
    const Vector3d of_u = at.u.slope * (i == 0 ? tangents_.su0 : tangents_.su1);
    const Vector3d of_v = at.v.slope * (j == 0 ? tangents_.sv0 : tangents_.sv1);
    for (int k = 0; k < 3; ++k) {
      result[k] += of_u[k];
      result[3 + k] += of_v[k];
    }
  }
  const double share = 1 + law(at.node).hardening;
  for (int k = 0; k < 9; ++k) result[k] -= share * from(at.node, k);
  return result;
}

double PlasticPlate::squared_norm(int node, const PlaceCurvatures& xi) const {
  return product_of(moduli_[static_cast<std::size_t>(node)], xi, xi);
}

bool PlasticPlate::yields(const Field& w, const PlasticField& from) const {
  for (int j = 0; j < grid_.rows; ++j) {
    for (int i = 0; i < grid_.columns; ++i) {
      const int node = grid_.node(i, j);
      const double yield = law(node).yield;
      if (squared_norm(node, stress(i, j, w, from)) > yield * yield) return true;
    }
  }
  return false;
}

bool PlasticPlate::flow(const Field& w, const PlasticField& from, PlasticField& to) {
  to = from;
  flowing_.clear();
  for (int j = 0; j < grid_.rows; ++j) {
    for (int i = 0; i < grid_.columns; ++i) {
      const int node = grid_.node(i, j);
      PlaceCurvatures xi = stress(i, j, w, from);
      const double squared = squared_norm(node, xi);
      const PlasticLaw own = law(node);
      if (!(squared > own.yield * own.yield)) continue;
      // Curvatures that are eliminated do not flow.
      if (along_u_[static_cast<std::size_t>(i)].is_eliminated) xi[0] = xi[1] = xi[2] = 0;
      if (along_v_[static_cast<std::size_t>(j)].is_eliminated) xi[3] = xi[4] = xi[5] = 0;
      const Flow& flow = flowing_.emplace_back(Flowing{i, j, {own, xi, squared}}).flow;
      for (int k = 0; k < 9; ++k) to(node, k) += flow.whole * xi[k];
    }
  }
  return !flowing_.empty();
}

void PlasticPlate::add_forces(const PlasticField& plastic, Field& forces) const {
  for (int j = 0; j < grid_.rows; ++j) {
    for (int i = 0; i < grid_.columns; ++i) {
      const int node = grid_.node(i, j);
      PlaceCurvatures here;
      bool is_flat = true;
      for (int k = 0; k < 9; ++k) {
        here[k] = plastic(node, k);
        is_flat = is_flat && here[k] == 0;
      }
      if (!is_flat) add_forces(stencil(i, j), here, forces);
    }
  }
}

void PlasticPlate::add_slope(const Field& way, Field& forces) const {
  for (const Flowing& one : flowing_) {
    const Stencil at = stencil(one.i, one.j);
    const Moduli<double>& moduli = moduli_[static_cast<std::size_t>(at.node)];
    add_forces(at, one.flow.change(moduli, curvatures(at, way)), forces);
  }
}

}  // namespace pliant
