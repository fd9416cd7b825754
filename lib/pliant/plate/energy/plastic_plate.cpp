#include "pliant/plate/energy/plastic_plate.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "pliant/core/expects.hpp"

namespace pliant {

PlasticPlate::PlasticPlate(const PlateProblem& problem, std::vector<int> components,
                           const PlateKernels& kernels)
    : kernels_(kernels),
      grid_(problem.outline.grid()),
      factors_(problem.factors),
      tangents_(problem.tangents),
      components_(std::move(components)) {
  PLIANT_EXPECTS(problem.law.has_value());
  law_ = *problem.law;
  const PlateSystem system = problem.system(1);
  const PlateEnergy energy(system);
  for (int i = 0; i < grid_.columns; ++i) along_u_.push_back(energy.along_u<double>(i));
  for (int j = 0; j < grid_.rows; ++j) along_v_.push_back(energy.along_v<double>(j));
  if (factors_) {
    for (int j = 0; j < grid_.rows; ++j) {
      for (int i = 0; i < grid_.columns; ++i) forms_.push_back(energy.moduli<double>(i, j));
    }
  } else {
    for (const int j : {0, 1, grid_.rows - 1}) {
      for (const int i : {0, 1, grid_.columns - 1}) forms_.push_back(energy.moduli<double>(i, j));
    }
  }
}

const Moduli<double>& PlasticPlate::form(int i, int j) const {
  if (factors_) return forms_[static_cast<std::size_t>(grid_.node(i, j))];
  const auto kind = [](int line, int count) { return line == 0 ? 0 : line < count - 1 ? 1 : 2; };
  const auto row = static_cast<std::size_t>(kind(j, grid_.rows));
  return forms_[3 * row + static_cast<std::size_t>(kind(i, grid_.columns))];
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

// What prescribed slopes add to the curvatures.
PlaceCurvatures PlasticPlate::by_tangents(int i, int j) const {
  const double of_u = along_u_[static_cast<std::size_t>(i)].slope;
  const double of_v = along_v_[static_cast<std::size_t>(j)].slope;
  PlaceCurvatures result = {};
  for (int k = 0; k < 3; ++k) {
    if (of_u != 0) result[k] = of_u * (i == 0 ? tangents_.su0 : tangents_.su1)[k];
    if (of_v != 0) result[3 + k] = of_v * (j == 0 ? tangents_.sv0 : tangents_.sv1)[k];
  }
  return result;
}

// xi = k - (1 + H) k_p.
PlaceCurvatures PlasticPlate::stress(int i, int j, const Field& w, const PlasticField& from) const {
  const int node = grid_.node(i, j);
  PlaceCurvatures result = curvatures(stencil(i, j), w);
  const PlaceCurvatures prescribed = by_tangents(i, j);
  const double share = 1 + law(node).hardening;
  for (int k = 0; k < 9; ++k) result[k] += prescribed[k] - share * from(node, k);
  return result;
}

double PlasticPlate::squared_stress(int i, int j, const Field& w, const PlasticField& from) const {
  const PlaceCurvatures xi = stress(i, j, w, from);
  return product_of(form(i, j), xi, xi);
}

// Those of a row. Its inner nodes have one stencil, and one form if the material is even.
void PlasticPlate::find_squared_stress(int j, const Field& w, const PlasticField& from,
                                       std::vector<double>& squared) const {
  const int columns = grid_.columns;
  std::fill(squared.begin(), squared.end(), 0.0);
  if (factors_) {
    for (int i = 0; i < columns; ++i) squared[i] = squared_stress(i, j, w, from);
    return;
  }
  squared[0] = squared_stress(0, j, w, from);
  squared[columns - 1] = squared_stress(columns - 1, j, w, from);
  const Stencil at = stencil(1, j);
  const Moduli<double> form = this->form(1, j);
  const PlaceCurvatures prescribed = by_tangents(1, j);  // across the row
  StressRow row;
  row.share = 1 + law_.hardening;
  row.twist = at.twist;
  for (const auto& [weights, of] : {std::pair{row.along, &at.u}, {row.across, &at.v}}) {
    weights[0] = of->before;
    weights[1] = of->here;
    weights[2] = of->after;
  }
  row.uu = form.uu;
  row.coupling = form.coupling;
  row.vv = form.vv;
  row.uv = form.uv;
  for (const int k : components_) {
    const double* const of = w.col(k).data();
    row.before = of + at.below;
    row.here = of + at.node;
    row.after = of + at.above;
    for (int kind = 0; kind < 3; ++kind)
      row.plastic[kind] = from.col(3 * kind + k).data() + at.node;
    row.slope = prescribed[3 + k];
    kernels_.add_squared_stress(row, columns - 2, squared.data() + 1);
  }
}

// Calls f(node) for nodes over `part` of their yield stress, ascending, until it returns false.
template <class F>
void PlasticPlate::for_each_over(double part, const Field& w, const PlasticField& from,
                                 const F& f) const {
  std::vector<double> squared(static_cast<std::size_t>(grid_.columns));
  const auto bound = [&](const PlasticLaw& law) { return part * law.yield * (part * law.yield); };
  const double even = bound(law_);
  for (int j = 0; j < grid_.rows; ++j) {
    find_squared_stress(j, w, from, squared);
    if (!factors_ && !(kernels_.longest(grid_.columns, squared.data()) > even)) continue;
    for (int i = 0; i < grid_.columns; ++i) {
      const int node = grid_.node(i, j);
      if (squared[i] > (factors_ ? bound(law(node)) : even) && !f(node)) return;
    }
  }
}

std::vector<int> PlasticPlate::nodes_over(double part, const Field& w,
                                          const PlasticField& from) const {
  std::vector<int> nodes;
  for_each_over(part, w, from, [&](int node) {
    nodes.push_back(node);
    return true;
  });
  return nodes;
}

bool PlasticPlate::yields(const Field& w, const PlasticField& from) const {
  bool yields = false;
  for_each_over(1, w, from, [&](int) {
    yields = true;
    return false;
  });
  return yields;
}

void PlasticPlate::add_forces(const PlasticField& plastic, Field& forces) const {
  for (int j = 0; j < grid_.rows; ++j) {
    for (int i = 0; i < grid_.columns; ++i) {
      const int node = grid_.node(i, j);
      PlaceCurvatures own;
      bool is_flat = true;
      for (int k = 0; k < 9; ++k) {
        own[k] = plastic(node, k);
        is_flat = is_flat && own[k] == 0;
      }
      if (is_flat) continue;
      const Stencil at = stencil(i, j);
      const PlaceCurvatures moments = moments_of(form(i, j), own);
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
  }
}

PlaceRows PlasticPlate::rows_of(const std::vector<int>& nodes, const std::vector<int>& numbers,
                                const Field& w) const {
  PlaceRows rows;
  rows.pattern_of.reserve(nodes.size());
  rows.starts.reserve(nodes.size() + 1);
  rows.unknowns.reserve(9 * nodes.size());
  rows.held.reserve(nodes.size());
  const int columns = grid_.columns, last = grid_.rows - 1;
  std::array<int, 9> patterns;  // of nodes at the ends of lines, if the material is even
  patterns.fill(-1);
  for (const int node : nodes) {
    const int i = node % columns, j = node / columns;
    const Stencil at = stencil(i, j);
    const int others[] = {at.node,       at.left,       at.right,      at.below,     at.above,
                          at.corners[0], at.corners[1], at.corners[2], at.corners[3]};
    int& pattern = patterns[(j == 0     ? 0
                             : j < last ? 3
                                        : 6) +
                            (i == 0            ? 0
                             : i < columns - 1 ? 1
                                               : 2)];
    if (pattern < 0 || factors_) {
      pattern = static_cast<int>(rows.patterns.size());
      const double t = at.twist;
      rows.patterns.push_back({form(i, j),
                               law(node),
                               at.area,
                               {{at.u.here, at.v.here, 0},
                                {at.u.before, 0, 0},
                                {at.u.after, 0, 0},
                                {0, at.v.before, 0},
                                {0, at.v.after, 0},
                                {0, 0, t},
                                {0, 0, -t},
                                {0, 0, -t},
                                {0, 0, t}}});
    }
    rows.pattern_of.push_back(pattern);
    PlaceCurvatures& held = rows.held.emplace_back(by_tangents(i, j));
    for (int n = 0; n < 9; ++n) {
      const int unknown = numbers[others[n]];
      rows.unknowns.push_back(unknown);
      const std::array<double, 3>& by = rows.patterns[pattern].by[n];
      for (int k = 0; unknown < 0 && k < 9; ++k) held[k] += by[k / 3] * w(others[n], k % 3);
    }
    rows.starts.push_back(rows.unknowns.size());
  }
  return rows;
}

}  // namespace pliant
