#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pliant/core/result.hpp"
#include "pliant/files/file_object.hpp"
#include "pliant/files/gltf/gltf_document.hpp"

namespace pliant::gltf {

/// A node of the scene that has faces.
struct Object {
  std::size_t node = 0;
  std::size_t mesh = 0;     ///< of the node
  Eigen::Matrix4d to_file;  ///< the product of the transforms down to the node
};

/// Whether a primitive is made of triangles and has the vertices for one.
bool has_faces(const Document& document, const Primitive& primitive);

/// The objects of the displayed scene, each node before its children and these in the order of the
/// file. Errors: nodes of the file that are within themselves, in the scene or not; a node that
/// occurs twice in the scene; Interrupted.
Result<std::vector<Object>> objects_of(const Document& document,
                                       const StopRequest& should_stop = {});

/// The object that `name` chooses, by the names of nodes and meshes. Errors: those of
/// `choose_object`.
Result<Object> choose(const Document& document, std::span<const Object> objects,
                      const std::string& name);

/// The objects with their names and sizes.
std::vector<FileObject> listed(const Document& document, std::span<const Object> objects);

}  // namespace pliant::gltf
