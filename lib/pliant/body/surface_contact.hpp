#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "pliant/body/body.hpp"
#include "pliant/body/patch_rows.hpp"
#include "pliant/contact/node_rows.hpp"
#include "pliant/plate/contact/step_contact.hpp"

namespace pliant {

/// Where colliders and the surface that meets them are at the steps of a frame. Internal to body.
class ContactPlaces {
 public:
  ContactPlaces() = default;

  /// `rest`: the nodes at rest at the frame, object space, which outlive it, as the inputs do.
  ContactPlaces(const BodyInputs& inputs, const Field& rest, int step_count);

  int step_count() const { return static_cast<int>(transforms_.size()) - 1; }
  /// Of those with moving meshes, only the ones that were posed last.
  const std::vector<PlacedCollider>& colliders(int step) const { return colliders_[step]; }

  /// Poses moving meshes as a step begins, and as it ends.
  void pose(int step);
  const Transform& transform(int step) const { return transforms_[step]; }

  /// A node at rest as a step begins, object space. [length]
  Vector3d rest(int step, int node) const;

  const Field& first_rest() const { return *rest_; }  ///< at the frame (#nodes x 3)
  const Field* next_rest() const;                     ///< at the next one; null: as at the frame

  /// The diagonal of the box around the nodes at rest at the frame, world. [length]
  double diagonal() const { return diagonal_; }

  /// How much nearer each node comes to a collider than its deformation radius, as the frame's
  /// steps begin and as it ends; its inside is all equally near. `displacement` (#nodes x 3):
  /// object space. [length]
  std::vector<double> depths(std::size_t collider, const Field& displacement) const;

 private:
  const BodyInputs* inputs_ = nullptr;
  const Field* rest_ = nullptr;
  std::vector<std::vector<PlacedCollider>> colliders_;  // at each step's beginning, and at the end
  std::vector<std::size_t> moving_meshes_;              // of the colliders
  std::vector<int> posed_;                              // the steps of which they are posed
  std::vector<Transform> transforms_;                   // of the surface, likewise
  double diagonal_ = 0;
};

/// The contact of a body, one patch after the other. docs/model.md, "Contact". Internal to body.
class SurfaceContact final : public StepContact {
 public:
  /// Begins a frame. `share`: of area that a node has, by which forces are multiplied. `before`:
  /// facts of the last solve.
  void begin_frame(ContactPlaces places, const std::vector<SampledCollider>& colliders,
                   double share, const std::vector<ContactFacts>& before);

  /// Turns to a patch, whose unknowns are the nodes of these rows in their order.
  void begin_patch(std::span<const RowRun> moved);

  /// Takes what touched in the last step of the patch.
  void end_patch();

  /// Finds what no patch moves and is inside. `displacement`: of a node at the end, object space.
  void end_frame(const std::function<Vector3d(int node)>& displacement);

  bool begin(int step, const Field& from, const Field& to) override;
  bool join(const Field& to) override;
  void end_freely_at(const Field& to) override;
  const std::vector<ContactRow>& rows() const override { return rows_; }
  void end(const std::vector<Vector3d>& forces) override;
  double tolerance() const override;
  Matrix3d to_plate() const override { return inverse_linear(places_.transform(step_ + 1)); }
  Matrix3d to_world() const override { return places_.transform(step_ + 1).linear; }

  /// Of each collider, once a frame has ended.
  std::vector<ContactFacts> take_facts() { return std::move(facts_); }

 private:
  struct Pair {
    int unknown, collider;
  };
  // A mesh at the end of a frame, in its collider's frame, and how far its points went.
  struct LastMesh {
    std::shared_ptr<const PosedMesh> posed = {};  // null: no mesh
    Vector3d scale = {1, 1, 1};
    double way = 0;
  };

  void keep_near_meshes();

  void place(int step, const Field& displacement, Field& world);
  std::vector<Pair> near_pairs() const;
  bool find(bool is_first);
  void note_squeeze(int collider, int squeezer);
  void list_rows();

  ContactPlaces places_;
  std::vector<SampledCollider> sampled_;
  double share_ = 1;
  std::vector<int> nodes_;          // of the unknowns
  Field rest_, next_rest_, shape_;  // these at rest at the frame, at the next one, as they are
  int step_ = 0;
  Field before_, free_, after_;        // the unknowns in the world: of a step, its end without
                                       // contact, and its end
  std::vector<std::uint8_t> joined_;   // of each collider, of each unknown
  std::vector<NearMesh> near_meshes_;  // of each collider, of each node; empty: none is a mesh
  std::vector<LastMesh> last_meshes_;  // of each collider, in the frame before
  NodeRows found_;
  std::vector<ContactRow> rows_;
  std::vector<std::uint8_t> moves_;   // of each node: whether some patch moves it
  std::vector<std::uint8_t> is_new_;  // of each collider: whether the last solve did not meet it
  std::vector<ContactFacts> facts_;
  struct Pushes {
    std::vector<int> nodes = {};
    Vector3d force = {0, 0, 0};
  };
  std::vector<NodesInside> thrown_;  // of each collider, as the patch's first step began
  std::vector<Pushes> pushes_;       // of each collider, in the patch's last step so far
};

}  // namespace pliant
