#pragma once

#include <memory>
#include <vector>

#include "pliant/body/elastic_body.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/plate/solver_cache.hpp"
#include "pliant/plate/vibration_cache.hpp"
#include "pliant/region/node_tiles.hpp"

namespace pliant {

/// One elastic surface as a grid of nodes. Its step allocates nothing while the regions stay the
/// same, plates are solved in sine space, no node recovers and the grid is open. Thesis 5.3;
/// SPEC 6.
class GridBody final : public ElasticBody {
 public:
  /// Starts at rest. Requires: `rest` is #nodes x 3, object space, finite; at least 3 x 3 nodes.
  /// `solver` and `context` are those of its plates; the context's profile receives the times of
  /// its steps. `factors` null: the material is even. `held` marks nodes that stay; null: none.
  /// `faces` null: no force uses normals.
  GridBody(const Grid& grid, Field rest, const BodySettings& settings,
           SolverChoice solver = SolverChoice::Auto, RunContext context = {},
           std::shared_ptr<const NodeFactors> factors = {},
           std::shared_ptr<const NodeMarks> held = {}, std::shared_ptr<const NodeFaces> faces = {});

  Result<StepPlan> look(const BodyInputs& inputs) const override;

  Push push_of(const BodyInputs& inputs, const StepPlan& plan, std::size_t force) const override;
  std::vector<MovedPatch> moved_patches(const StepPlan& plan, std::size_t region) const override;
  std::unique_ptr<PatchPlate> plate_of(const BodyInputs& inputs, const StepPlan& plan,
                                       std::size_t region, std::size_t patch) const override;
  SolverCounts solver_counts() const override { return solvers_.counts(); }

  const Grid& grid() const { return grid_; }

 private:
  // Memory for a selection.
  struct Room {
    NodeTiles tiles;       // of the nodes that forces measure
    Field measured;        // these nodes, if the rest shape is animated
    NodeTiles rest_tiles;  // of the nodes at rest, if needed
    std::vector<std::uint8_t> marks;
  };

  struct Solve final : BodyPatch {
    PlateInterval& interval() override { return problem; }

    const Patch* patch = nullptr;
    Box box = {};  // that of the problem's factors; empty: of none yet
    PlateProblem problem;
  };

  Result<void> plan(const BodyInputs& inputs, Room& room, StepPlan& plan) const;
  void hold_nodes(const BodyInputs& inputs, Region& region) const;
  bool is_held_within(const BodyInputs& inputs, const Patch& patch) const;
  void find_lost(const BodyInputs& inputs, Room& room, Selection& selection) const;
  void keep_outlines();
  void find_rows(Solve& one) const;

  Result<void> select(const BodyInputs& inputs, StepPlan& plan) override {
    return this->plan(inputs, room_, plan);
  }
  void keep_patches(const BodyInputs& inputs) override;
  std::size_t patch_count() const override { return solves_.size(); }
  BodyPatch& patch(std::size_t k) override { return solves_[k]; }
  std::string not_held(std::size_t k) const override;
  void take_material(const BodyInputs& inputs, std::size_t k) override;
  Result<double> smallest_eigenvalue_of(std::size_t k) override;
  EdgeTangents tangents_of(const EdgeTangents& tangents, std::size_t k) const override;
  void find_load(const BodyInputs& inputs, std::size_t k) override;
  void find_displacement(std::size_t k) override;
  Result<void> advance(std::size_t k) override;
  double contact_share() const override { return grid_.hu * grid_.hv; }
  void find_met(const BodyInputs& inputs, const StepPlan& plan, std::vector<Box>& boxes) const;

  Grid grid_;
  SolverCache solvers_;
  VibrationCache vibrations_;
  Room room_;
  std::vector<Solve> solves_;  // one for each patch, in the order of the regions
};

}  // namespace pliant
