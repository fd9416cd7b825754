#pragma once

#include <array>
#include <memory>
#include <vector>

#include "pliant/body/body.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/mesh/point_tree.hpp"
#include "pliant/mesh/triangle_surface.hpp"
#include "pliant/plate/triangles/triangle_plate.hpp"
#include "pliant/region/surface/surface_load.hpp"

namespace pliant {

/// The bending form of a surface's plates; `unit` is that of its `TriangleSurface`.
Bending bending_of(const BodyInputs& inputs, const std::array<double, 2>& unit, Border border);

/// One elastic surface as triangles, of any mesh. docs/model.md, "Surfaces".
class SurfaceBody final : public Body {
 public:
  /// Starts at rest. Requires: settings.reference is Rest. `solver` and `context` are those of its
  /// plates; the context's profile receives the times of its steps.
  SurfaceBody(std::shared_ptr<const TriangleSurface> surface, const BodySettings& settings,
              SolverChoice solver = SolverChoice::Auto, RunContext context = {});

  Result<StepPlan> look(const BodyInputs& inputs) const override;
  Result<void> step(const BodyInputs& inputs) override;
  const StepPlan& last_step() const override { return plan_; }
  Push push_of(const BodyInputs&, const StepPlan& plan, std::size_t force) const override {
    return plan.surface->forces[force].push;
  }
  SolverCounts solver_counts() const override;

  const TriangleSurface& surface() const { return *surface_; }

 private:
  // A piece while it is solved.
  struct PieceSolve {
    std::unique_ptr<TrianglePlate> plate;
    TriangleProblem problem;
    TriangleState state;
  };

  Result<void> plan(const BodyInputs& inputs, StepPlan& plan) const;
  void select_all(SurfaceSelection& selection) const;
  Result<void> weigh(const BodyInputs& inputs, SurfaceSelection& selection) const;
  void keep_plates();
  Result<void> solve(const BodyInputs& inputs);
  TriangleState state_of(const SurfacePiece& piece) const;
  Result<void> take();
  void mark_unsettled();

  std::shared_ptr<const TriangleSurface> surface_;
  PointTree tree_;               // of the rest positions
  std::vector<bool> is_border_;  // of nodes
  double settling_length_;       // with `Release::Recover` [length]
  SolverChoice solver_;
  RunContext context_;
  StepPlan plan_;
  std::vector<PieceSolve> solves_;  // of the pieces that move, in their order
  SolverCounts past_counts_;        // of the plates that are gone
  Field next_positions_, next_velocities_;
};

}  // namespace pliant
