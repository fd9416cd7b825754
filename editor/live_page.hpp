#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/simulation/simulation.hpp"
#include "viewer/json.hpp"

namespace pliant::editor {

using viewer::Json;

/// World positions of all surfaces of a frame, rounded to the nearest float: of each the number of
/// its vertices (uint32), then x y z of each (float32), little-endian. Errors: NotFinite beyond the
/// range of float.
Result<std::string> positions_bytes(const Frame& frame);

/// What a page draws of a scene that changes, but for the positions of its surfaces. Arrays of
/// shapes have keys, so that a page asks only for new ones; docs/editor.md has the members.
class LivePage {
 public:
  /// JSON: the head of a page of `pliant view` without arrays, and of each shape its key. Errors:
  /// those of the colliders' meshes; Interrupted.
  Result<std::string> scene(std::int64_t revision, const Simulation& simulation,
                            const StopRequest& should_stop);

  /// A packed head with arrays: of each surface its regions and what colliders push at a frame, and
  /// all messages so far. Errors: those of `Simulation::report`.
  Result<std::string> details(Simulation& simulation, int frame) const;

  /// The arrays of a shape; null: there is none with that key. Thread-safe.
  std::shared_ptr<const std::string> shape(const std::string& key) const;

 private:
  using Shapes = std::map<std::string, std::shared_ptr<const std::string>>;

  // What was made of a surface at rest.
  struct Shown {
    Mesh mesh;
    std::vector<int> nodes;
    std::shared_ptr<const NodeMarks> held;
    Json facts;
    std::string key;
  };

  struct ShownCollider {
    Collider collider;
    std::shared_ptr<const ColliderMesh> mesh;
    Json facts;
  };

  Result<Json> shape_facts(const RestShape& shape, Shapes& shapes, const StopRequest& should_stop);

  // Of the scene before.
  std::vector<Shown> shown_ = {};
  std::vector<ShownCollider> colliders_ = {};
  FrameSpan frames_before_ = {};

  mutable std::mutex mutex_;  // guards the shapes, of this scene and the one before
  Shapes shapes_, older_;
};

}  // namespace pliant::editor
