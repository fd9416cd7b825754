#include "pliant/files/write_mesh.hpp"

#include <algorithm>
#include <cstring>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pliant/core/text.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/files/file_object.hpp"
#include "pliant/files/obj/obj_text.hpp"
#include "pliant/files/obj/read_obj.hpp"
#include "pliant/files/ply/ply_bytes.hpp"
#include "pliant/files/ply/read_ply.hpp"
#include "pliant/mesh/triangles/equal_numbers.hpp"

namespace pliant {
namespace {

// Also tells 0 and -0 apart.
template <class Numbers>
bool have_same_bits(const Numbers& a, const Numbers& b) {
  return a.size() == b.size() &&
         (a.size() == 0 ||
          std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(*a.data())) ==
              0);
}

bool are_same(const std::vector<VertexAttribute>& a, const std::vector<VertexAttribute>& b) {
  return std::ranges::equal(a, b, [](const VertexAttribute& one, const VertexAttribute& other) {
    return one.name == other.name && have_same_bits(one.values, other.values);
  });
}

// Whether each face has the same name, or none.
bool are_same(const FaceNames& a, const FaceNames& b, std::size_t face_count) {
  const auto name_of = [](const FaceNames& names, std::size_t face) -> std::string_view {
    const int index = names.of_faces.empty() ? -1 : names.of_faces[face];
    return index < 0 ? "" : std::string_view(names.names[static_cast<std::size_t>(index)]);
  };
  for (std::size_t face = 0; face < face_count; ++face)
    if (name_of(a, face) != name_of(b, face)) return false;
  return true;
}

// Whether the same corners share a normal.
bool have_same_normals(const Mesh& a, const Mesh& b, StopPoll& poll) {
  return numbers_of_equal(a.corner_normals, poll) == numbers_of_equal(b.corner_normals, poll);
}

// What of a mesh is not in the one that was read back.
std::vector<std::string_view> lost_parts(const Mesh& mesh, const Mesh& back, StopPoll& poll) {
  std::vector<std::string_view> lost;
  const auto compare = [&](std::string_view part, bool is_same) {
    if (!is_same) lost.push_back(part);
  };
  compare("vertices", have_same_bits(mesh.positions, back.positions));
  const bool has_faces =
      mesh.face_sizes == back.face_sizes && mesh.corner_vertices == back.corner_vertices;
  compare("faces", has_faces);
  if (!has_faces) return lost;
  compare("(u,v)", have_same_bits(mesh.uvs, back.uvs) && mesh.corner_uvs == back.corner_uvs);
  compare("normals", have_same_normals(mesh, back, poll));
  compare("materials", are_same(mesh.materials, back.materials, mesh.face_sizes.size()));
  compare("groups", are_same(mesh.groups, back.groups, mesh.face_sizes.size()));
  compare("attributes", are_same(mesh.attributes, back.attributes));
  return lost;
}

Result<void> check_attribute_names(const std::vector<std::string>& names) {
  for (auto name = names.begin(); name != names.end(); ++name) {
    if (!is_ply_attribute(*name))
      return invalid(
          fmt::format("an attribute has the name {}, but in a .ply it must be one word "
                      "that is not that of a coordinate, of a normal or of (u,v)",
                      in_quotes(*name)));
    if (std::find(names.begin(), name, *name) != name)
      return invalid(fmt::format("two attributes have the name {}", in_quotes(*name)));
  }
  return {};
}

Result<std::string> bytes_as(std::string_view ending, const Mesh& mesh,
                             const StopRequest& should_stop) {
  std::string bytes;
  const ByteSink sink = [&](std::string_view piece) -> Result<void> {
    bytes += piece;
    return {};
  };
  Result<void> written;
  if (ending == ".obj") {
    const auto text = ObjText::make(mesh, should_stop);
    if (!text) return fail(text.error());
    written = text->write(mesh.positions, sink, should_stop);
  } else {
    auto ply = PlyBytes::make(mesh, PlyBytes::Content::Exact, should_stop);
    if (!ply) return fail(ply.error());
    written = ply->write(mesh.positions, sink, should_stop);
  }
  if (!written) return fail(written.error());
  return bytes;
}

Result<std::string> checked_bytes(const Mesh& mesh, const std::string& file,
                                  const StopRequest& should_stop) {
  const std::string ending = ending_of(file);
  if (ending != ".obj" && ending != ".ply")
    return invalid(fmt::format("a mesh is written as .obj or .ply, but the name ends in {}",
                               in_quotes(ending)));
  if (auto checked = check_mesh(mesh, should_stop); !checked) return fail(checked.error());
  std::vector<std::string> names;
  for (const VertexAttribute& attribute : mesh.attributes) names.push_back(attribute.name);
  if (ending == ".ply") {
    if (auto checked = check_attribute_names(names); !checked) return fail(checked.error());
  }
  auto bytes = bytes_as(ending, mesh, should_stop);
  if (!bytes) return bytes;
  if (bytes->size() > largest_mesh_file)
    return invalid(fmt::format("the mesh takes {} bytes as {}, but at most {} are read",
                               bytes->size(), ending, largest_mesh_file));
  const auto back = ending == ".obj" ? parse_obj(*bytes, file, {}, should_stop)
                                     : parse_ply(*bytes, file, {}, names, should_stop);
  if (!back) return fail(back.error());
  StopPoll poll(should_stop);
  const std::vector<std::string_view> lost = lost_parts(mesh, *back, poll);
  if (poll.after(0)) return interrupted();
  if (!lost.empty())
    return invalid(fmt::format("the format {} cannot keep these of the mesh as they are: {}",
                               ending, fmt::join(lost, ", ")));
  return bytes;
}

}  // namespace

Result<std::string> mesh_bytes(const Mesh& mesh, const std::string& file,
                               const StopRequest& should_stop) {
  return about_mesh_file(file, [&] { return checked_bytes(mesh, file, should_stop); });
}

Result<void> write_mesh(const Mesh& mesh, const std::string& file, const StopRequest& should_stop) {
  const auto bytes = mesh_bytes(mesh, file, should_stop);
  if (!bytes) return fail(bytes.error());
  return write_file(file, *bytes, should_stop);
}

}  // namespace pliant
