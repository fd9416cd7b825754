#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"

namespace pliant {

/// What a message quotes from a file: in quotes, and short enough to be read.
std::string in_quotes(std::string_view text);

/// Which of a file's objects is meant: the one of that name, or the only one when `object` is
/// empty. Errors, listing the first names: no object of that name, several of it, or none named
/// where there are several. Requires: names is not empty.
Result<std::size_t> choose_object(std::span<const std::string> names, const std::string& object);

/// Which object of a file is meant that names both its nodes and their meshes: by the names of the
/// nodes, and by those of the meshes if no node has the name. Errors: there is none; those of
/// `choose_object`. Requires: as many nodes as meshes.
Result<std::size_t> choose_node(std::span<const std::string> nodes,
                                std::span<const std::string> meshes, const std::string& object);

/// Turns positions of an object into those of its file. Errors: the transform is not affine.
Result<void> to_file_space(const Eigen::Matrix4d& to_file, Field& positions);

/// Whether an object with `set_count` sets of (u,v) has the set `uv_set`, counted from 0. Set 0 may
/// be missing: a mesh without (u,v) is a mesh. Errors: says how many sets there are.
Result<void> check_uv_set(int uv_set, int set_count);

}  // namespace pliant
