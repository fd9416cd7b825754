#include "pliant/files/obj/obj_text.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "pliant/mesh/normals.hpp"

namespace pliant {
namespace {

// A name that can be read back: one line, no comment, no continued line.
std::string in_line(std::string name) {
  std::replace_if(
      name.begin(), name.end(),
      [](char c) { return (c >= 0 && c < ' ') || c == '#' || c == '\x7f'; }, '_');
  if (name.ends_with('\\')) name.back() = '_';
  return name;
}

// Writes a statement before a face if its name differs from that of the face before.
class NameStatement {
 public:
  NameStatement(std::string_view keyword, const FaceNames& names, std::string_view nobody)
      : keyword_(keyword), names_(names), nobody_(nobody) {}

  void append(std::size_t face, std::string& text) {
    if (names_.of_faces.empty() || names_.of_faces[face] == current_) return;
    current_ = names_.of_faces[face];
    const std::string name = current_ < 0
                                 ? std::string(nobody_)
                                 : in_line(names_.names[static_cast<std::size_t>(current_)]);
    text.append(keyword_).append(name.empty() ? "" : " ").append(name).push_back('\n');
  }

 private:
  std::string_view keyword_;
  const FaceNames& names_;
  std::string_view nobody_;
  int current_ = -1;
};

// For each face, whether it shares no normal with another. Unfinished if it is stopped.
std::vector<bool> flat_faces(const Mesh& mesh, StopPoll& poll) {
  std::vector<bool> is_flat(mesh.face_sizes.size(), !mesh.corner_normals.empty());
  if (mesh.corner_normals.empty()) return is_flat;
  constexpr int none = -1, several = -2;
  std::vector<int> face_of(static_cast<std::size_t>(normal_count(mesh)), none);
  for (const bool is_second_pass : {false, true}) {
    std::size_t corner = 0;
    for (std::size_t face = 0; face < mesh.face_sizes.size(); ++face) {
      if (poll.after(4)) return is_flat;
      for (int k = 0; k < mesh.face_sizes[face]; ++k, ++corner) {
        int& known = face_of[static_cast<std::size_t>(mesh.corner_normals[corner])];
        if (is_second_pass) {
          if (known == several) is_flat[face] = false;
        } else {
          known =
              known == none || known == static_cast<int>(face) ? static_cast<int>(face) : several;
        }
      }
    }
  }
  return is_flat;
}

}  // namespace

Result<ObjText> ObjText::make(const Mesh& mesh, const StopRequest& should_stop) {
  constexpr std::size_t parts_of_number = 64;
  StopPoll poll(should_stop);
  ObjText made(mesh);
  if (!mesh.object.empty()) made.head_ = "o " + in_line(mesh.object) + '\n';
  std::string& topology = made.topology_;
  auto out = std::back_inserter(topology);
  for (const auto& [u, v] : mesh.uvs) {
    if (poll.after(2 * parts_of_number)) return interrupted();
    fmt::format_to(out, "vt {} {}\n", u, v);
  }
  NameStatement group("g", mesh.groups, ""), material("usemtl", mesh.materials, "");
  const std::vector<bool> is_flat = flat_faces(mesh, poll);
  std::size_t corner = 0;
  for (std::size_t face = 0; face < mesh.face_sizes.size(); ++face) {
    if (poll.after(parts_of_number * static_cast<std::size_t>(mesh.face_sizes[face])))
      return interrupted();
    group.append(face, topology);
    material.append(face, topology);
    if (face == 0 || is_flat[face] != is_flat[face - 1])
      topology += is_flat[face] ? "s off\n" : "s 1\n";
    topology += 'f';
    for (int k = 0; k < mesh.face_sizes[face]; ++k, ++corner) {
      fmt::format_to(out, " {}", mesh.corner_vertices[corner] + 1);
      const int uv = mesh.corner_uvs[corner] + 1;
      const bool has_normal = !mesh.corner_normals.empty();
      if (uv > 0) {
        fmt::format_to(out, "/{}", uv);
      } else if (has_normal) {
        topology += '/';
      }
      if (has_normal) fmt::format_to(out, "/{}", mesh.corner_normals[corner] + 1);
    }
    topology += '\n';
  }
  return made;
}

Result<void> ObjText::write(const Field& positions, const ByteSink& sink,
                            const StopRequest& should_stop) const {
  TextPieces out(sink, should_stop);
  out.text = head_;
  auto end = std::back_inserter(out.text);
  for (Eigen::Index row = 0; row < positions.rows(); ++row) {
    fmt::format_to(end, "v {} {} {}\n", positions(row, 0), positions(row, 1), positions(row, 2));
    if (auto passed = out.pass_on(); !passed) return passed;
  }
  if (!mesh_.corner_normals.empty()) {
    const auto normals = unit_normals(mesh_, positions, should_stop);
    if (!normals) return fail(normals.error());
    for (Eigen::Index row = 0; row < normals->rows(); ++row) {
      const Eigen::RowVector3f normal = normals->row(row).cast<float>();
      fmt::format_to(end, "vn {} {} {}\n", normal[0], normal[1], normal[2]);
      if (auto passed = out.pass_on(); !passed) return passed;
    }
  }
  if (auto passed = out.finish(); !passed) return passed;
  return write_in_pieces(topology_, should_stop, sink);
}

}  // namespace pliant
