#pragma once

#include <map>
#include <optional>
#include <vector>

#include "pliant/contact/collider.hpp"

namespace pliant {

/// The half-space behind which a convex solid lies, that a node is kept in: n . p >= height. World.
struct NodeRow {
  int node = 0;
  int collider = 0;
  Vector3d normal = {0, 1, 0};  ///< of length 1
  double height = 0;            ///< [length]
  Vector3d place = {0, 0, 0};   ///< where the node came to lie, at the end of the step [length]
  bool sticks = false;          ///< the node is held there

  double lack(const Vector3d& at) const;  ///< how far a node there is outside [length]
};

/// What is known of how near a node is to a mesh, so that it need not be looked for again. No row
/// depends on it.
struct NearMesh {
  int triangle = -1;           ///< that is near; -1: nothing is known
  Vector3d place = {0, 0, 0};  ///< in the collider's frame
  double distance = 0;         ///< there
  double mesh_way = 0;         ///< as of the collider, then
};

/// Whether what is known of a mesh says that a place in the collider's frame is farther from it
/// than `distance`.
bool is_known_to_be_farther(const PlacedCollider& mesh, const Vector3d& x, double distance,
                            const NearMesh& near);

/// Looks for the signed distance to a mesh, without its offset. [length]
double distance_to_mesh(const PlacedCollider& mesh, const Vector3d& x, NearMesh& near);

/// The row of a node that touches on its way from `before` to `after`, world; null: it does not.
/// docs/model.md, "Contact".
std::optional<NodeRow> row_of(const PlacedCollider& from, const PlacedCollider& to,
                              const Vector3d& before, const Vector3d& after, double slack,
                              NearMesh* near_mesh = nullptr);

/// The row of a node that lies on a solid as a step begins, nearer than `near`: at its closest
/// point; null: it does not.
std::optional<NodeRow> lying_row_of(const PlacedCollider& from, const PlacedCollider& to,
                                    const Vector3d& before, double near);

/// The rows of a step, so chosen that all can be satisfied: at most three at a node, of which none
/// oppose each other; one that sticks is the only one.
class NodeRows {
 public:
  enum class Offer {
    Taken,
    Same,      ///< as another row, which lacks more; or instead of one that lacks less
    Squeezed,  ///< against another row, which came earlier and stays
    Dropped,   ///< it would be one too many
  };

  void clear() { rows_.clear(); }
  bool is_empty() const { return rows_.empty(); }

  /// `at` is where the row's node is now. The rows of a node come in the order in which they are
  /// offered.
  Offer add(const NodeRow& row, const Vector3d& at);

  /// The row that keeps another from its node; null: none is against it.
  const NodeRow* squeezer_of(const NodeRow& row) const;

  /// By node, ascending, and in the order in which they came.
  std::vector<NodeRow> all() const;

 private:
  std::map<int, std::vector<NodeRow>> rows_;
};

}  // namespace pliant
