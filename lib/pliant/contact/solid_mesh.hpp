#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/hash.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/mesh/triangles/point_tree.hpp"

namespace pliant {

// Closed meshes as solids. docs/model.md, "Contact".

/// An edge of triangles that closed ones do not have.
struct OpenEdge {
  int from = 0, to = 0;
  int sides = 1;  ///< triangles that lie there; 2: both run through it from `from` to `to`
};

/// The triangles of a closed mesh, which are the same wherever its points are: in a tree, so that a
/// search visits few of them.
class SolidMesh {
 public:
  using Corners = std::array<int, 3>;

  /// The first edge, in the order of triangles and corners, without two triangles that run through
  /// it in opposite directions; null: the triangles are closed.
  static std::optional<OpenEdge> open_edge(std::span<const Corners> triangles);

  /// Turns all triangles round if `points` (#points x 3, finite) have a volume < 0. Requires: at
  /// least one triangle, and no open edge. Errors: Interrupted.
  static Result<std::shared_ptr<const SolidMesh>> make(std::vector<Corners> triangles,
                                                       const Field& points,
                                                       const StopRequest& should_stop = {});

  const std::vector<Corners>& triangles() const { return triangles_; }
  int point_count() const { return static_cast<int>(corner_starts_.size()) - 1; }

  /// The triangle at the other side of an edge, which begins at a corner.
  int neighbour(int triangle, int corner) const { return neighbours_[triangle][corner]; }

  /// The corners at a point: three times their triangle, and which of its corners.
  std::span<const int> corners_at(int point) const {
    return {corners_of_points_.data() + corner_starts_[point],
            static_cast<std::size_t>(corner_starts_[point + 1] - corner_starts_[point])};
  }

  const std::vector<PointTree::Cluster>& clusters() const { return tree_.clusters(); }
  const std::vector<int>& order() const { return tree_.rows(); }  ///< of triangles in the leaves
  int place_of(int triangle) const { return places_[triangle]; }  ///< in that order

  const Hash& hash() const { return hash_; }  ///< of the triangles

  /// What it takes, with `poses` of it. [bytes]
  static std::size_t bytes(std::size_t triangles, std::size_t points, std::size_t poses);

 private:
  SolidMesh() = default;

  std::vector<Corners> triangles_, neighbours_;
  std::vector<int> corner_starts_, corners_of_points_;
  PointTree tree_;  // of the centres of the triangles
  std::vector<int> places_;
  Hash hash_;
};

/// A closed mesh with its points where they are.
class PosedMesh {
 public:
  using Triangle = std::array<Vector3d, 3>;
  struct Box {
    Vector3d low, high;
  };

  /// Requires: `points` (#points x 3) are finite. `is_mirrored`: they show what is outside inside.
  PosedMesh(std::shared_ptr<const SolidMesh> mesh, Field points, bool is_mirrored = false);

  const SolidMesh& mesh() const { return *mesh_; }
  const std::shared_ptr<const SolidMesh>& shared_mesh() const { return mesh_; }
  const Field& points() const { return points_; }
  bool is_mirrored() const { return is_mirrored_; }

  const Triangle& at(int place) const { return triangles_[place]; }  ///< in the order of the leaves
  const Box& box(int cluster) const { return boxes_[cluster]; }
  double diagonal() const { return length_of((boxes_[0].high - boxes_[0].low).transpose()); }

  /// The mesh with each component of its points multiplied; `mesh` itself by 1. The last one is
  /// kept. Thread-safe.
  static std::shared_ptr<const PosedMesh> scaled(const std::shared_ptr<const PosedMesh>& mesh,
                                                 const Vector3d& scale);

 private:
  std::shared_ptr<const SolidMesh> mesh_;
  Field points_;
  bool is_mirrored_;
  std::vector<Triangle> triangles_;
  std::vector<Box> boxes_;

  mutable std::mutex mutex_;  // of what follows
  mutable Vector3d scale_ = {1, 1, 1};
  mutable std::shared_ptr<const PosedMesh> scaled_;
};

/// A place of a mesh: a triangle, and the weights of its corners, of sum 1.
struct MeshPlace {
  int triangle = 0;
  std::array<double, 3> weights = {1, 0, 0};
};

/// How near a place is to a mesh, and to which place of it.
struct MeshNearness {
  double distance = 0;          ///< signed: < 0 inside [length]
  Vector3d normal = {0, 1, 0};  ///< its gradient, of length 1
  MeshPlace foot;
};

/// A way that a mesh's points go evenly from where one pose has them to where another one does,
/// and searches at a part `t` of it. Both are poses of one mesh, which outlive it; the same if it
/// stands still.
class MeshWay {
 public:
  MeshWay(const PosedMesh& from, const PosedMesh& to) : from_(from), to_(to) {}

  bool moves() const { return &from_ != &to_; }

  /// The signed distance by the closest place, of equally close ones that of the first triangle,
  /// with the sign of its normal weighted by angles (J. A. Baerentzen, H. Aanaes, 2005). Infinite
  /// if squares of areas are. Faster if the triangle `near` is near; -1: none is known.
  MeshNearness nearness(const Vector3d& x, double t, int near = -1) const;

  Vector3d place(const MeshPlace& place, double t) const;

  /// A place that goes straight from `x0` to `x1`, and a distance that grows evenly; > 0.
  struct Mover {
    Vector3d x0, x1;
    double near0, near1;
  };
  struct Meeting {
    double t = 0;
    int triangle = 0;
  };

  /// The first moment from `begin` up to `end` at which the mover is within its distance of some
  /// triangle; null: there is none. Of a mesh that changes its shape it may be earlier.
  std::optional<Meeting> meeting(const Mover& mover, double begin, double end) const;

  /// The first moment from `begin` up to `end` at which the mover is not within its distance of one
  /// triangle; null: there is none.
  std::optional<double> parting(const Mover& mover, int triangle, double begin, double end) const;

  double diagonal() const { return from_.diagonal(); }

 private:
  struct Foot;
  struct Search;

  PosedMesh::Triangle triangle_at(int place, double t) const;
  PosedMesh::Box box_at(int cluster, double t) const;
  void try_triangle(int place, const Vector3d& x, double t, Foot& best) const;
  Vector3d unit_normal(int triangle, double t) const;
  Vector3d normal_at(const MeshPlace& place, const Vector3d& at, double t) const;
  Vector3d gathered_normal(const Vector3d& at, double t) const;
  std::optional<double> first_within(int place, const Mover& mover, double begin, double end) const;

  const PosedMesh& from_;
  const PosedMesh& to_;
};

}  // namespace pliant
