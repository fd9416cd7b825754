#pragma once

#include <span>
#include <string>

#include "pliant/core/result.hpp"
#include "pliant/files/gltf/gltf_accessor.hpp"
#include "pliant/files/gltf/gltf_document.hpp"
#include "pliant/files/gltf/gltf_scene.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant::gltf {

/// The mesh of an object, its primitives combined, transformed to the place of its node in the
/// file. Errors: as `parse_gltf`, without the file.
Result<Mesh> mesh_of(const Document& document, const Object& object, AccessorReader& accessors,
                     int uv_set, std::span<const std::string> attributes = {},
                     const StopRequest& should_stop = {});

}  // namespace pliant::gltf
