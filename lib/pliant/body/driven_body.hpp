#pragma once

#include "pliant/body/body.hpp"
#include "pliant/body/patch_plate.hpp"

namespace pliant {

/// The body of a surface that another one drives: it has no nodes, and its step changes nothing.
class DrivenBody final : public Body {
 public:
  explicit DrivenBody(const BodySettings& settings) : Body(Field(0, 3), 0, settings, {}, {}, {}) {}

  Result<StepPlan> look(const BodyInputs&) const override { return StepPlan{}; }
  Result<void> step(const BodyInputs&) override { return {}; }
  const StepPlan& last_step() const override { return no_step_; }
  const Field& velocities_before() const override { return rest(); }
  Push push_of(const BodyInputs&, const StepPlan&, std::size_t) const override { return {}; }
  std::vector<MovedPatch> moved_patches(const StepPlan&, std::size_t) const override { return {}; }
  std::unique_ptr<PatchPlate> plate_of(const BodyInputs&, const StepPlan&, std::size_t,
                                       std::size_t) const override {
    return nullptr;
  }
  SolverCounts solver_counts() const override { return {}; }

 private:
  StepPlan no_step_;
};

}  // namespace pliant
