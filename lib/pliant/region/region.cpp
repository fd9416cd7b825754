#include "pliant/region/region.hpp"

#include "pliant/core/expects.hpp"

namespace pliant {

Selection select_region(const Grid& grid, const Field& nodes,
                        std::span<const SampledForce> forces) {
  PLIANT_EXPECTS(nodes.rows() == grid.node_count());
  Selection selection;
  selection.forces.reserve(forces.size());
  for (const SampledForce& force : forces) {
    ForceSelection selected;
    for (int j = 0; j < grid.rows; ++j) {
      for (int i = 0; i < grid.columns; ++i) {
        const double delta = distance(force.shape, nodes.row(grid.node(i, j)).transpose());
        if (delta < force.deformation_radius) selected.deformation.include(i, j);
        if (delta < force.force_radius) selected.force.include(i, j);
      }
    }
    selection.region.include(selected.deformation);
    selection.forces.push_back(selected);
  }
  return selection;
}

Field assemble_load(const Grid& grid, const Field& nodes, std::span<const SampledForce> forces,
                    const Selection& selection) {
  PLIANT_EXPECTS(nodes.rows() == grid.node_count());
  PLIANT_EXPECTS(selection.forces.size() == forces.size() && !selection.region.is_empty());
  const Box& region = selection.region;
  Field load = Field::Zero(Eigen::Index{region.columns()} * region.rows(), 3);
  for (std::size_t k = 0; k < forces.size(); ++k) {
    const Box box = intersection(region, selection.forces[k].force);
    for (int j = box.j0; j <= box.j1; ++j) {
      for (int i = box.i0; i <= box.i1; ++i) {
        const int row = (j - region.j0) * region.columns() + (i - region.i0);
        load.row(row) += force_at(forces[k], nodes.row(grid.node(i, j)).transpose()).transpose();
      }
    }
  }
  return load;
}

}  // namespace pliant
