#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "pliant/core/result.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// Text from a file for a message: in quotes, and shortened.
std::string in_quotes(std::string_view text);

/// The first of some names, each in quotes.
std::string listed_names(std::span<const std::string> names);

/// The index of the object with the given name; if `object` is empty, of the only one. Errors,
/// listing the first names: no object of that name, several of it, or no name given and several
/// objects. Requires: names is not empty.
Result<std::size_t> choose_object(std::span<const std::string> names, const std::string& object);

/// The index of the object with the given name in a file that names both nodes and their meshes: by
/// the names of the nodes; if no node has the name, by those of the meshes. Errors: there is none;
/// those of `choose_object`. Requires: as many nodes as meshes.
Result<std::size_t> choose_node(std::span<const std::string> nodes,
                                std::span<const std::string> meshes, const std::string& object);

/// Transforms an object to the space of its file. Its faces are turned round if that reflects them,
/// so that they keep their outer sides. Errors: the transform is not affine.
Result<void> to_file_space(const Eigen::Matrix4d& to_file, Mesh& mesh);

/// Whether an object with `set_count` sets of (u,v) has the set `uv_set`, counted from 0. Set 0 may
/// be missing: a mesh need not have (u,v). Errors: names the number of sets.
Result<void> check_uv_set(int uv_set, int set_count);

}  // namespace pliant
