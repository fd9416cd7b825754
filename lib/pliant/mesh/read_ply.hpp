#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// Reads a PLY file, version 1.0, ASCII or binary of either byte order. Numbers are read exactly,
/// doubles as doubles; vertices and faces keep the order of the file.
///
/// A reader of our own, because assimp 5.2 holds coordinates in single precision, never comes back
/// from a header that breaks off, and takes a file that is cut short for a whole one, whose missing
/// vertices lie anywhere.
///
/// Of the element `vertex` x, y, z are read, and (u,v) under the names in use: `s t`, `u v`,
/// `texture_u texture_v`, `tx ty`; of `face` the list `vertex_indices` or `vertex_index`, and the
/// list `texcoord` of u v u v … for its corners, which goes before (u,v) of vertices. Normals `nx
/// ny nz` of vertices say which of those at one place join smoothly. Everything else is passed
/// over. Points without faces and faces of fewer than three corners, which are points and lines,
/// are passed over too.
///
/// The file's one object has no name; any `object` but the empty one is an error.
///
/// Errors, with the line where there are lines: a header that is none or that does not end; an
/// element or number that is not there or not finite; more after the last element; an index outside
/// the file; no faces. Unreadable: the file cannot be read. OutOfMemory.
Result<Mesh> read_ply(const std::filesystem::path& file, const std::string& object = {});

/// The same from bytes; `name` stands for the file in messages.
Result<Mesh> parse_ply(std::string_view bytes, const std::string& name,
                       const std::string& object = {});

}  // namespace pliant
