#include "pliant/body/field_rows.hpp"

#include <cmath>
#include <utility>

#include "pliant/region/closed_boxes.hpp"

namespace pliant {
namespace {

using RowView = Eigen::Map<Eigen::ArrayXd>;
using ConstRowView = Eigen::Map<const Eigen::ArrayXd>;

// Calls f(component, node, row, count) for the contiguous stretches of the nodes `within` a box:
// `node` is the first row in a field on all nodes, `row` that in a field on the box.
template <int components = 3, class F>
void for_rows(const Grid& grid, const Box& box, const Box& within, const F& f) {
  for (int component = 0; component < components; ++component) {
    for (int j = within.j0; j <= within.j1; ++j) {
      const Eigen::Index row = Eigen::Index{j - box.j0} * box.columns() + (within.i0 - box.i0);
      for_each_stretch(grid, within.i0, within.i1, j, [&](int node, int offset, int count) {
        f(component, Eigen::Index{node}, row + offset, Eigen::Index{count});
      });
    }
  }
}

// Calls f(first, count) for the contiguous stretches of nodes outside the interior of a box,
// ascending.
template <class F>
void for_stretches_around(const Grid& grid, const Box& hole, const F& f) {
  Eigen::Index first = 0;
  if (hole.columns() > 2) {
    for (int j = hole.j0 + 1; j < hole.j1; ++j) {
      f(first, grid.node(hole.i0 + 1, j) - first);
      first = grid.node(hole.i1, j);
    }
  }
  f(first, grid.node_count() - first);
}

// NaN if a number is not finite, else 0.
double unsoundness(const RowView& numbers) {
  return (numbers - numbers).sum();  // NOLINT(misc-redundant-expression): 0 only if finite
}

template <class Rows>
Rows any_rows_of(const Grid& grid, const Box& box, const Rows& nodes, Rows reuse) {
  constexpr int components = Rows::ColsAtCompileTime;
  reuse.resize(Eigen::Index{box.columns()} * box.rows(), components);
  for_rows<components>(
      grid, box, box, [&](int component, Eigen::Index node, Eigen::Index row, Eigen::Index count) {
        reuse.col(component).segment(row, count) = nodes.col(component).segment(node, count);
      });
  return reuse;
}

}  // namespace

Field rows_of(const Grid& grid, const Box& box, const Field& nodes, Field reuse) {
  return any_rows_of(grid, box, nodes, std::move(reuse));
}

PlasticField rows_of(const Grid& grid, const Box& box, const PlasticField& nodes,
                     PlasticField reuse) {
  return any_rows_of(grid, box, nodes, std::move(reuse));
}

void put_rows(const Grid& grid, const Box& box, const PlasticField& rows, PlasticField& nodes) {
  for_rows<9>(grid, box, box,
              [&](int component, Eigen::Index node, Eigen::Index row, Eigen::Index count) {
                nodes.col(component).segment(node, count) = rows.col(component).segment(row, count);
              });
}

Field difference_of(const Grid& grid, const Box& box, const Field& a, const Field& b, Field reuse) {
  reuse.resize(Eigen::Index{box.columns()} * box.rows(), 3);
  for_rows(grid, box, box,
           [&](int component, Eigen::Index node, Eigen::Index row, Eigen::Index count) {
             reuse.col(component).segment(row, count) =
                 a.col(component).segment(node, count) - b.col(component).segment(node, count);
           });
  return reuse;
}

bool put_interior(const Grid& grid, const Patch& patch, const Field& displacement,
                  const Field& velocity, const Field* reference, Field& positions,
                  Field& velocities) {
  double unsound = 0;
  const auto put = [&](int component, Eigen::Index node, Eigen::Index row, Eigen::Index count) {
    RowView position(&positions(node, component), count);
    RowView speed(&velocities(node, component), count);
    const ConstRowView moved(&displacement(row, component), count);
    if (reference) {
      position = ConstRowView(&(*reference)(node, component), count) + moved;
    } else {
      position = moved;
    }
    speed = ConstRowView(&velocity(row, component), count);
    unsound += unsoundness(position) + unsoundness(speed);
  };
  for_rows(grid, patch.box, patch.inner(),
           [&](int component, Eigen::Index node, Eigen::Index row, Eigen::Index width) {
             if (patch.interior.empty()) {
               put(component, node, row, width);
               return;
             }
             for (Eigen::Index k = 0; k < width; ++k) {
               if (patch.interior[static_cast<std::size_t>(row + k)])
                 put(component, node + k, row + k, 1);
             }
           });
  return unsound == 0;
}

void copy_around(const Grid& grid, const Box& hole, const Field& from, Field& to) {
  to.resize(from.rows(), 3);
  for (int component = 0; component < 3; ++component) {
    for_stretches_around(grid, hole, [&](Eigen::Index first, Eigen::Index count) {
      to.col(component).segment(first, count) = from.col(component).segment(first, count);
    });
  }
}

void clear_around(const Grid& grid, const Box& hole, Field& nodes) {
  nodes.resize(grid.node_count(), 3);
  for (int component = 0; component < 3; ++component) {
    for_stretches_around(grid, hole, [&](Eigen::Index first, Eigen::Index count) {
      nodes.col(component).segment(first, count).setZero();
    });
  }
}

}  // namespace pliant
