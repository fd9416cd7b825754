#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pliant/body/body.hpp"
#include "pliant/body/patch_rows.hpp"
#include "pliant/body/surface_contact.hpp"
#include "pliant/core/run_context.hpp"

namespace pliant {

/// A patch of the frame's regions, with its plate and its place in the body. Internal to body.
struct BodyPatch {
  BodyPatch() = default;
  BodyPatch(BodyPatch&&) = default;
  BodyPatch& operator=(BodyPatch&&) = default;
  virtual ~BodyPatch() = default;

  virtual PlateInterval& interval() = 0;  ///< of its plate's problem

  int region = 0;              ///< patches of one region, side by side, have one damping
  bool moves = true;           ///< whether it is solved
  bool is_held = true;         ///< false: a static plate has no solution
  double settling_length = 0;  ///< with `Release::Recover` [length]

  std::vector<RowRun> nodes;    ///< of the rows of velocity
  std::vector<RowRun> moved;    ///< of those rows that the plate moves
  std::vector<RowRun> plastic;  ///< of the rows of plastic curvatures
  Eigen::Index rows = 0, plastic_rows = 0;

  PlateState state;
};

/// A surface that is stepped: what grids and triangles have in common. They differ in how they
/// select, in the load of a patch, and in its plate.
class ElasticBody : public Body {
 public:
  Result<void> step(const BodyInputs& inputs) final;
  const StepPlan& last_step() const final { return plan_; }
  const Field& velocities_before() const final { return next_.velocities; }

 protected:
  ElasticBody(Field rest, Eigen::Index plastic_places, const BodySettings& settings,
              RunContext context, std::shared_ptr<const NodeFactors> factors,
              std::shared_ptr<const NodeMarks> held, std::shared_ptr<const NodeFaces> faces)
      : Body(std::move(rest), plastic_places, settings, std::move(factors), std::move(held),
             std::move(faces)),
        context_(std::move(context)) {}

  /// The positions from which the frame is solved: those that settle are at rest.
  const Field& first_positions() const {
    return plan_.settling.empty() ? state_.positions : next_.positions;
  }

  RunContext context_;
  StepPlan plan_;

 private:
  /// Selects; `plan` is the last one.
  virtual Result<void> select(const BodyInputs& inputs, StepPlan& plan) = 0;

  /// Makes the patches those of `plan_`. Plates that stay keep what they have.
  virtual void keep_patches(const BodyInputs& inputs) = 0;
  virtual std::size_t patch_count() const = 0;
  virtual BodyPatch& patch(std::size_t k) = 0;

  // Of patch k, which moves.
  virtual std::string not_held(std::size_t k) const = 0;  ///< why a static one is not solved
  virtual void take_material(const BodyInputs& inputs, std::size_t k) = 0;
  virtual Result<double> smallest_eigenvalue_of(std::size_t k) = 0;
  virtual EdgeTangents tangents_of(const EdgeTangents& tangents, std::size_t k) const = 0;
  virtual void find_load(const BodyInputs& inputs, std::size_t k) = 0;
  virtual void find_displacement(std::size_t k) = 0;
  virtual Result<void> advance(std::size_t k) = 0;  ///< its state

  /// The area by which a force of contact on a node is multiplied to be one in the world.
  virtual double contact_share() const = 0;

  void begin_next();
  Result<void> solve(const BodyInputs& inputs);
  Result<Dynamics> dynamics_of(const BodyInputs& inputs, std::size_t first, std::size_t end);
  Result<void> move(const BodyInputs& inputs, const Dynamics& dynamics, std::size_t k);
  void begin_load(BodyPatch& one) const;
  void keep_push(const EdgeTangents& tangents);
  Result<void> take();
  void mark_unsettled();

  SurfaceContact contact_;
  BodyState next_;  // until it is complete; then the one before
};

}  // namespace pliant
