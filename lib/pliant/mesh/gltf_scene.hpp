#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pliant/core/result.hpp"
#include "pliant/mesh/gltf_document.hpp"

namespace pliant::gltf {

/// A node of the scene that has faces.
struct Object {
  std::string node_name;
  std::string mesh_name;
  Eigen::Matrix4d to_file;  ///< the product of the transforms down to the node
  std::size_t mesh = 0;
  std::vector<std::size_t> primitives;  ///< those of the mesh that have faces
};

/// Whether a primitive is made of triangles and has the vertices for one.
bool has_faces(const Document& document, const Primitive& primitive);

/// The objects of the displayed scene, each node before its children and these in the order of the
/// file. Errors: a node that occurs twice in it, possibly within itself.
Result<std::vector<Object>> objects_of(const Document& document);

/// The object with the given name: by the names of the nodes; if no node has it, by those of the
/// meshes. Errors: no faces at all; those of `choose_node`.
Result<Object> choose(std::vector<Object> objects, const std::string& name);

}  // namespace pliant::gltf
