#include "pliant/plate/domain_operator.hpp"

#include <cstddef>
#include <vector>

#include "pliant/core/expects.hpp"

namespace pliant {
namespace {

// The number of each interior node among the unknowns, -1 for the others.
std::vector<int> unknown_numbers(const PlateSystem& system) {
  PLIANT_EXPECTS(system.interior.size() == static_cast<std::size_t>(system.grid.node_count()));
  std::vector<int> numbers(system.interior.size(), -1);
  int next = 0;
  for (std::size_t node = 0; node < numbers.size(); ++node) {
    if (system.interior[node]) numbers[node] = next++;
  }
  return numbers;
}

}  // namespace

SparseMatrix assemble_upper_of_domain(const PlateSystem& system) {
  const Grid& grid = system.grid;
  const int M = grid.columns;
  // Eq. (4) and (5) gathered by neighbour; the upper triangle has the neighbours with smaller
  // numbers.
  const StencilWeights weights(system);

  const std::vector<int> numbers = unknown_numbers(system);
  const int size = unknown_count(system);
  SparseMatrix matrix(size, size);
  matrix.reserve(Eigen::Index{7} * size);
  for (int node = 0; node < grid.node_count(); ++node) {
    const int column = numbers[node];
    if (column < 0) continue;
    matrix.startVec(column);
    const auto add = [&](int offset, double weight) {
      if (numbers[node + offset] >= 0) matrix.insertBack(numbers[node + offset], column) = weight;
    };
    // Eq. (13): a node two steps away counts unless the one between is rim.
    if (numbers[node - M] >= 0) add(-2 * M, weights.two_v);
    add(-M - 1, weights.corner);
    add(-M, weights.beside_v);
    add(-M + 1, weights.corner);
    if (numbers[node - 1] >= 0) add(-2, weights.two_u);
    add(-1, weights.beside_u);
    // Eq. (7): beside a rim node, the ghost behind it adds its weight to the node it mirrors.
    const int ghosts_u = (numbers[node - 1] < 0) + (numbers[node + 1] < 0);
    const int ghosts_v = (numbers[node - M] < 0) + (numbers[node + M] < 0);
    matrix.insertBack(column, column) =
        weights.centre + ghosts_u * weights.two_u + ghosts_v * weights.two_v;
  }
  matrix.finalize();
  return matrix;
}

Field residual_of_domain(const PlateSystem& system, const Field& w, const Field& f) {
  using Real = ExtendedStencil::Real;
  const Grid& grid = system.grid;
  const int M = grid.columns;
  const std::ptrdiff_t two_rows = std::ptrdiff_t{2} * M;
  const ExtendedStencil stencil(system);

  const std::vector<int> numbers = unknown_numbers(system);
  PLIANT_EXPECTS(w.rows() == unknown_count(system) && f.rows() == w.rows());
  Field result(f.rows(), 3);
  std::vector<Real> nodes(numbers.size());  // the rim remains 0
  for (int component = 0; component < 3; ++component) {
    for (std::size_t node = 0; node < numbers.size(); ++node) {
      if (numbers[node] >= 0) nodes[node] = w(numbers[node], component);
    }
    for (int node = 0; node < grid.node_count(); ++node) {
      const int row = numbers[node];
      if (row < 0) continue;
      const Real* const p = &nodes[node];
      const Real left = numbers[node - 1] < 0 ? p[0] : p[-2];
      const Real right = numbers[node + 1] < 0 ? p[0] : p[2];
      const Real below = numbers[node - M] < 0 ? p[0] : p[-two_rows];
      const Real above = numbers[node + M] < 0 ? p[0] : p[two_rows];
      result(row, component) =
          static_cast<double>(f(row, component) - stencil.at(p, left, right, below, above));
    }
  }
  return result;
}

}  // namespace pliant
