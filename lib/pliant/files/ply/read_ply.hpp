#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/files/file_object.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// Reads a PLY file, version 1.0, ASCII or binary of either byte order. Numbers are read exactly,
/// doubles as doubles; vertices and faces keep the order of the file.
///
/// An own reader, because assimp 5.2 stores coordinates in single precision, never returns from a
/// truncated header, and accepts a truncated file as complete, with arbitrary positions for the
/// missing vertices.
///
/// Properties read from the element `vertex`: x, y, z, and (u,v) under the usual names: `s t`, `u
/// v`, `texture_u texture_v`, `tx ty`; from `face`: the list `vertex_indices` or `vertex_index`,
/// and the list `texcoord` of u v u v … for its corners, which has precedence over (u,v) of
/// vertices; from `tristrips`: the same list, of corners of strips of triangles, where -1 ends a
/// strip. Normals `nx ny nz` decide which vertices at one place join smoothly. What `write_mesh`
/// adds has precedence over these: an element `texcoord` of `u v` with a list `texcoord_indices` of
/// each face, and a list `normal_indices`, equal at corners that share a normal. Everything else is
/// skipped, also points without faces.
///
/// As other programs do, it leaves out faces of fewer than three corners, edges, (u,v) that are no
/// numbers or do not exist, lists of a face's corners of another length than the face, and bytes
/// after the last element.
/// `Mesh::left_out` counts them.
///
/// `attributes` names properties of the element `vertex`, numbers, that the mesh keeps as its
/// attributes.
///
/// The file's one object has no name; an `object` other than `#1` is an error.
///
/// Errors, with the line if the file has lines: no header, or one that does not end; an element or
/// number that is missing; a coordinate or attribute that is not finite; an attribute that is no
/// property; an index out of range; no faces. Unreadable: the file cannot be read. OutOfMemory;
/// Interrupted.
Result<Mesh> read_ply(const std::filesystem::path& file, const std::string& object = {},
                      std::span<const std::string> attributes = {},
                      const StopRequest& should_stop = {});

/// The same from bytes; `name` is the file's name in messages.
Result<Mesh> parse_ply(std::string_view bytes, const std::string& name,
                       const std::string& object = {}, std::span<const std::string> attributes = {},
                       const StopRequest& should_stop = {});

/// The one object of the file. Errors: as `read_ply`.
Result<std::vector<FileObject>> ply_objects(const std::filesystem::path& file,
                                            const StopRequest& should_stop = {});

}  // namespace pliant
