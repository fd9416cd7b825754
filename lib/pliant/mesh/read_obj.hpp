#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// Reads a Wavefront OBJ file: `v`, `vt`, `vn`, `f`, `o`, `g`, `s` and `usemtl`; every other
/// statement is passed over. Quads and larger faces stay what they are, and vertices keep the order
/// of the file.
///
/// `s off` makes faces flat; others are as their `vn` say, or smooth within their `s`, or smooth. A
/// `vn` that cannot be read, and a corner's number of one that is not there, count as none: normals
/// are computed anew, and only who shares them is taken from the file.
///
/// A reader of our own, because none of the libraries at hand reads numbers exactly: tinyobjloader
/// (2.0 rc10) changes the last bits of about half of all decimals, 0.375 among them, and takes
/// `1,5` as 1 and `nan` as 0, both without a word; assimp reorders and drops vertices. A lattice
/// whose coordinates are exact must stay exact, or the selection's "strictly less" (SPEC 5) goes
/// wrong.
///
/// `object` names the `o` to take when the file holds several with faces; its mesh then has just
/// the vertices that its faces use, in the order of the file. Empty: the file's only object.
///
/// Errors, each with its line, at most 20: a number that is none or not finite; a face with fewer
/// than three corners; an index outside the file; no faces; an object that is not there, or that
/// is there twice, or none named where there are several. Unreadable: the file cannot be read.
Result<Mesh> read_obj(const std::filesystem::path& file, const std::string& object = {});

/// The same from text; `name` stands for the file in messages.
Result<Mesh> parse_obj(std::string_view text, const std::string& name,
                       const std::string& object = {});

}  // namespace pliant
