#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "pliant/body/grid_body.hpp"
#include "pliant/mesh/grid_mapping.hpp"
#include "pliant/mesh/grid_sheet.hpp"

namespace pliant::testing {

/// A grid with its rest positions, `count` x `rows` nodes with a spacing of 1 around the origin.
struct NodeSheet {
  Grid grid;
  Field rest;
};

inline NodeSheet flat_sheet(int columns, int rows) {
  const auto mapping = find_grid(
      make_mesh({.columns = columns, .rows = rows, .width = columns - 1.0, .depth = rows - 1.0}));
  return {mapping->grid, mapping->rest};
}

/// With hills, so that the rest shape is not a solution of the equation without reference.
inline NodeSheet hilly_sheet(int columns, int rows) {
  NodeSheet s = flat_sheet(columns, rows);
  for (int node = 0; node < s.grid.node_count(); ++node) {
    s.rest(node, 1) = std::sin(0.7 * s.rest(node, 0)) * std::cos(0.4 * s.rest(node, 2));
  }
  return s;
}

/// A force that selects nodes nearer than `radius` in the plane of the sheet at rest.
inline SampledForce press(double x, double z, double magnitude, double radius = 3.5) {
  return {PointForce{{x, 0, z}, {0.2, 1, 0}}, magnitude, radius, radius / 2, Falloff::Constant};
}

inline BodyInputs inputs_of(std::vector<SampledForce> forces) {
  BodyInputs in;
  in.dynamics = {4000, 2000};
  in.frame_length = 1.0 / 24;
  in.dt = 0.01;
  in.forces = std::move(forces);
  return in;
}

/// Steps a body; a copy of its plan.
inline Result<StepPlan> step(Body& body, const BodyInputs& inputs) {
  if (auto stepped = body.step(inputs); !stepped) return fail(stepped.error());
  return body.last_step();
}

inline double peak_of(const Body& body) {
  return (body.state().positions - body.rest()).rowwise().norm().maxCoeff();
}

}  // namespace pliant::testing
