#pragma once

#include <map>
#include <string>
#include <vector>

#include "pliant/files/gltf/gltf_shape.hpp"
#include "pliant/files/gltf/gltf_spool.hpp"
#include "pliant/files/writer.hpp"
#include "pliant/files/written_mesh.hpp"

namespace pliant {

// Keys of one property of a node, a row of `width` floats each. Internal to files.
struct GltfKeys {
  const char* path;  // the property's name in an animation channel
  int width;
  std::vector<float> numbers = {};

  bool is_moving() const;
};

// One surface or collider of a glTF file: writes its static parts first, then a morph target for
// each frame with a new shape. Internal to files.
class GltfSurface {
 public:
  using Json = GltfBuffer::Json;

  /// Errors: Interrupted.
  static Result<GltfSurface> make(const AnimatedSurface& surface, WrittenAs as,
                                  const StopRequest& should_stop);

  /// Writes the static parts. Errors: those of the buffer; NotFinite.
  Result<void> begin(const Field& rest, int frame, GltfBuffer& buffer);

  /// Writes one frame. Errors: likewise.
  Result<void> add(const SurfacePose& pose, int frame, GltfBuffer& buffer);

  /// The mesh; `material_of` returns the index of a material by its name; empty: the unnamed one;
  /// null: that of colliders.
  Json mesh(const std::function<std::size_t(const std::string*)>& material_of) const;

  Json node(std::size_t mesh_index) const;

  /// Whether the shape or the placement changes.
  bool is_animated() const;

  /// Adds the animation of the node to the animation of all surfaces. Errors: those of the buffer.
  Result<void> animate(std::size_t node_index, std::size_t times, GltfBuffer& buffer,
                       Json& animation) const;

 private:
  struct Target {
    int frame;
    std::size_t positions, normals;  // accessors
  };

  GltfSurface(const AnimatedSurface& surface, WrittenAs as, StopRequest should_stop);
  bool is_placed() const { return as_ != WrittenAs::Surface; }
  Result<std::vector<float>> normals_at(const Field& positions) const;

  std::string name_;
  WrittenMesh written_;
  const Mesh& mesh_;
  WrittenAs as_;
  StopRequest should_stop_;
  GltfShape shape_;
  Json attributes_;
  std::vector<std::size_t> indices_;        // accessors of the shape's parts
  std::vector<float> base_, base_normals_;  // #vertices x 3
  std::vector<Target> targets_;
  std::map<std::string, int> target_of_shape_;  // by the hash of its numbers
  std::vector<int> target_of_frame_;
  std::vector<GltfKeys> keys_;       // of what is placed
  std::vector<bool> is_shown_ = {};  // at each frame
};

}  // namespace pliant
