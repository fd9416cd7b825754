#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "pliant/body/elastic_body.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/mesh/triangles/point_tree.hpp"
#include "pliant/mesh/triangles/triangle_surface.hpp"
#include "pliant/plate/triangles/triangle_plate.hpp"
#include "pliant/region/triangles/triangle_load.hpp"

namespace pliant {

/// The bending form of a surface's plates, without the factors; `unit` is that of its
/// `TriangleSurface`.
Bending bending_of(const BodyInputs& inputs, const std::array<double, 2>& unit, Border border);

/// Whether any three of a surface's nodes at rest are far from one line: what a goal pulls back
/// there cannot move without it.
bool are_beyond_line(const Field& rest, const std::vector<int>& nodes);

/// Factors at the nodes of a surface as means over the corners of each of its triangles
/// (#triangles); a centre has the mean of its face's corners. None stay none.
std::vector<double> means_on_triangles(const TriangleSurface& surface,
                                       const std::vector<double>& at_nodes);

/// One elastic surface as triangles, of any mesh. docs/model.md, "Surfaces".
class TriangleBody final : public ElasticBody {
 public:
  /// Starts at rest. Requires: settings.reference is Rest. `solver` and `context` are those of its
  /// plates; the context's profile receives the times of its steps. `factors` null: the material is
  /// even. `held` marks nodes that stay; null: none.
  TriangleBody(const std::shared_ptr<const TriangleSurface>& surface, const BodySettings& settings,
               SolverChoice solver = SolverChoice::Auto, RunContext context = {},
               std::shared_ptr<const NodeFactors> factors = {},
               std::shared_ptr<const NodeMarks> held = {})
      : TriangleBody(surface, std::make_shared<const PointTree>(surface->rest), settings, solver,
                     std::move(context), std::move(factors), std::move(held)) {}

  /// The same with the tree of the surface's nodes.
  TriangleBody(std::shared_ptr<const TriangleSurface> surface,
               std::shared_ptr<const PointTree> tree, const BodySettings& settings,
               SolverChoice solver, RunContext context, std::shared_ptr<const NodeFactors> factors,
               std::shared_ptr<const NodeMarks> held);

  Result<StepPlan> look(const BodyInputs& inputs) const override {
    return look_again(inputs, StepPlan(plan_));
  }
  Result<StepPlan> look_again(const BodyInputs& inputs, StepPlan&& earlier) const override;
  Push push_of(const BodyInputs&, const StepPlan& plan, std::size_t force) const override {
    return plan.surface->forces[force].push;
  }
  std::vector<MovedPatch> moved_patches(const StepPlan& plan, std::size_t region) const override;
  std::unique_ptr<PatchPlate> plate_of(const BodyInputs& inputs, const StepPlan& plan,
                                       std::size_t region, std::size_t patch) const override;
  SolverCounts solver_counts() const override;

  const TriangleSurface& surface() const { return *surface_; }

 private:
  struct Solve final : BodyPatch {
    PlateInterval& interval() override { return problem; }

    const TrianglePatch* patch = nullptr;
    std::unique_ptr<TrianglePlate> plate;  // null: the patch does not move
    TriangleProblem problem;
    // Of the plate's slowest vibration with `bending` and `goal`, if known.
    std::optional<double> lambda;
    Bending bending;
    double goal = 0;
  };

  Result<void> plan(const BodyInputs& inputs, StepPlan& plan) const;
  void find_what_holds(const BodyInputs& inputs, TriangleSelection& selection) const;
  Result<void> select_all(TriangleSelection& selection) const;
  Result<void> plan_on(const TriangleSurface& surface, const PointTree& tree,
                       const BodyInputs& inputs, StepPlan& plan) const;
  Result<void> weigh(const TriangleSurface& surface, const PointTree& tree,
                     const BodyInputs& inputs, TriangleSelection& selection) const;
  std::unique_ptr<TrianglePlate> make_plate(const TriangleSelection& selection, std::size_t k,
                                            SolverChoice solver) const;
  void find_rows(Solve& one) const;
  int first_node(std::size_t k) const;
  std::span<const std::uint8_t> held() const {
    return held_ ? std::span(*held_) : std::span<const std::uint8_t>();
  }

  Result<void> select(const BodyInputs& inputs, StepPlan& plan) override {
    return this->plan(inputs, plan);
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
  double contact_share() const override { return 1; }

  std::shared_ptr<const TriangleSurface> surface_;
  std::shared_ptr<const PointTree> tree_;  // of the surface's nodes
  std::vector<bool> is_border_;            // of nodes
  double settling_length_;                 // with `Release::Recover` [length]
  SolverChoice solver_;
  std::vector<Solve> solves_;  // of the patches, in their order
  SolverCounts past_counts_;   // of the plates that are gone
};

}  // namespace pliant
