#include "pliant/output/obj_text.hpp"

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

// For each face, whether it shares no normal with another.
std::vector<bool> flat_faces(const Mesh& mesh) {
  std::vector<bool> is_flat(mesh.face_sizes.size(), !mesh.corner_normals.empty());
  if (mesh.corner_normals.empty()) return is_flat;
  constexpr int none = -1, several = -2;
  std::vector<int> face_of(static_cast<std::size_t>(normal_count(mesh)), none);
  for (const bool is_second_pass : {false, true}) {
    std::size_t corner = 0;
    for (std::size_t face = 0; face < mesh.face_sizes.size(); ++face) {
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

ObjText::ObjText(const Mesh& mesh) : mesh_(mesh) {
  if (!mesh.object.empty()) head_ = "o " + in_line(mesh.object) + '\n';
  auto out = std::back_inserter(topology_);
  for (const auto& [u, v] : mesh.uvs) fmt::format_to(out, "vt {} {}\n", u, v);
  NameStatement group("g", mesh.groups, ""), material("usemtl", mesh.materials, "");
  const std::vector<bool> is_flat = flat_faces(mesh);
  std::size_t corner = 0;
  for (std::size_t face = 0; face < mesh.face_sizes.size(); ++face) {
    group.append(face, topology_);
    material.append(face, topology_);
    if (face == 0 || is_flat[face] != is_flat[face - 1])
      topology_ += is_flat[face] ? "s off\n" : "s 1\n";
    topology_ += 'f';
    for (int k = 0; k < mesh.face_sizes[face]; ++k, ++corner) {
      fmt::format_to(out, " {}", mesh.corner_vertices[corner] + 1);
      const int uv = mesh.corner_uvs[corner] + 1;
      const bool has_normal = !mesh.corner_normals.empty();
      if (uv > 0) {
        fmt::format_to(out, "/{}", uv);
      } else if (has_normal) {
        topology_ += '/';
      }
      if (has_normal) fmt::format_to(out, "/{}", mesh.corner_normals[corner] + 1);
    }
    topology_ += '\n';
  }
}

Result<void> ObjText::write(const Field& positions, const ByteSink& sink) {
  if (auto written = sink(head_); !written) return written;
  vertices_.clear();
  auto out = std::back_inserter(vertices_);
  for (Eigen::Index row = 0; row < positions.rows(); ++row)
    fmt::format_to(out, "v {} {} {}\n", positions(row, 0), positions(row, 1), positions(row, 2));
  if (auto written = sink(vertices_); !written) return written;
  if (!mesh_.corner_normals.empty()) {
    vertices_.clear();
    const Eigen::Matrix<float, Eigen::Dynamic, 3> normals =
        unit_normals(mesh_, positions).cast<float>();
    for (Eigen::Index row = 0; row < normals.rows(); ++row)
      fmt::format_to(out, "vn {} {} {}\n", normals(row, 0), normals(row, 1), normals(row, 2));
    if (auto written = sink(vertices_); !written) return written;
  }
  return sink(topology_);
}

}  // namespace pliant
