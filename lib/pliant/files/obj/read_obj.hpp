#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

struct FileObject;

/// Reads a Wavefront OBJ file: `v`, `vt`, `vn`, `f`, `o`, `g`, `s` and `usemtl`; all other
/// statements are skipped. Quads and larger faces are kept, and vertices keep the order of the
/// file.
///
/// `s off` makes faces flat; other faces follow their `vn`, or are smooth within their `s`, or are
/// smooth. A `vn` that cannot be parsed, and a reference to one that does not exist, count as none:
/// normals are computed anew, and the file only decides which corners share them.
///
/// As other programs do, it leaves out faces of fewer than three corners, lines and points;
/// corners' references to (u,v) and normals that are missing or do not exist; (u,v) that are no
/// numbers; colours and further numbers of vertices that cannot be read. `Mesh::left_out` counts
/// them, for the whole file.
///
/// An own reader, because no available library reads numbers exactly: tinyobjloader (2.0 rc10)
/// changes the last bits of about half of all decimals, 0.375 among them, and reads `1,5` as 1 and
/// `nan` as 0, both silently; assimp reorders and drops vertices. A lattice whose coordinates are
/// exact must stay exact, or the selection's "strictly less" (SPEC 5) fails.
///
/// `object` chooses the `o` to read if the file has several with faces (`find_objects`); faces
/// ahead of the first `o` are one without a name. Its mesh then has only the vertices that its
/// faces use, in the order of the file. Empty: the file's only object.
///
/// Errors, each with its line, at most 20: a coordinate that is invalid or not finite; a corner
/// that cannot be read; a vertex number out of range; a statement of more than 16 MiB; no faces;
/// those of `choose_object`. Unreadable: the file cannot be read. Interrupted.
Result<Mesh> read_obj(const std::filesystem::path& file, const std::string& object = {},
                      const StopRequest& should_stop = {});

/// The same from text; `name` is the file's name in messages.
Result<Mesh> parse_obj(std::string_view text, const std::string& name,
                       const std::string& object = {}, const StopRequest& should_stop = {});

/// The objects of the file. Errors: as `read_obj`.
Result<std::vector<FileObject>> obj_objects(const std::filesystem::path& file,
                                            const StopRequest& should_stop = {});

}  // namespace pliant
