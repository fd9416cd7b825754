#include "pliant/files/boxed/read_assimp.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <future>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/boxed/boxed_reader.hpp"
#include "pliant/files/boxed/mesh_message.hpp"
#include "pliant/files/file_object.hpp"
#include "pliant/files/open_file.hpp"
#include "pliant/mesh/face_names.hpp"
#include "pliant/mesh/normals.hpp"

namespace pliant {
namespace {

// Reduces a text with arbitrary content to one line: assimp quotes the file in some of its reasons.
std::string in_one_line(std::string_view reason) {
  constexpr std::size_t longest = 200;
  std::string line;
  for (const char c : reason.substr(0, longest)) {
    const bool is_blank = c == ' ' || c == '\n' || c == '\r' || c == '\t';
    if (is_blank && (line.empty() || line.back() == ' ')) continue;
    line += is_blank ? ' ' : c > ' ' && c < '\x7f' ? c : '?';
  }
  while (line.ends_with(' ')) line.pop_back();
  return reason.size() > longest ? line + "…" : line;
}

// Why assimp does not read a file. It reads FBX of all years since 2011, unlike it says.
std::string told_reason(std::string_view reason) {
  if (reason.find("old format version") != std::string_view::npos)
    return "it is older than FBX 7.1 (2011); FBX 7.1 to 7.7 are read, so export it again, or "
           "convert "
           "it by opening and exporting it in another program";
  return in_one_line(reason);
}

std::string format_name(const std::string& ending) { return ending == ".fbx" ? "FBX" : "Collada"; }

// The names of the objects, and those of their meshes.
struct Names {
  std::vector<std::string_view> objects, meshes;

  explicit Names(const MeshMessage& message) {
    for (const ObjectEntry& each : message.objects) {
      objects.emplace_back(each.node.empty() ? each.mesh : each.node);
      meshes.emplace_back(each.mesh);
    }
  }
};

Result<void> check_sets(const MeshMessage& message, int uv_set) {
  for (const Submesh& submesh : message.submeshes) {
    const int set_count = std::popcount(submesh.uv_sets);
    if (!submesh.uvs.empty()) continue;
    if (auto checked = check_uv_set(uv_set, set_count); !checked) return checked;
    if (set_count > 0)  // a file may omit its first set
      return invalid(fmt::format("the object has UV sets, but not set {}", uv_set));
  }
  return {};
}

// Whether an int can count vertices and corners.
Result<void> check_size(const MeshMessage& message) {
  std::uint64_t vertices = 0, corners = 0;
  for (const Submesh& submesh : message.submeshes) {
    vertices += submesh.positions.size() / 3;
    corners += submesh.corners.size();
  }
  constexpr std::uint64_t most = std::numeric_limits<int>::max();
  if (vertices <= most && corners <= most) return {};
  return invalid(fmt::format(
      "the object has {} vertices and {} corners of faces; at most {} of each are allowed",
      vertices, corners, most));
}

// Appends the faces of one submesh, whose vertices and (u,v) are numbered from the given ones on.
Result<void> append_faces(const Submesh& submesh, int first_vertex, int first_uv, Mesh& mesh) {
  const std::size_t vertex_count = submesh.positions.size() / 3;
  for (std::size_t face = 0; face < submesh.sizes.size(); ++face)
    mesh.face_sizes.push_back(static_cast<int>(submesh.sizes[face]));
  for (std::size_t corner = 0; corner < submesh.corners.size(); ++corner) {
    const std::uint32_t index = submesh.corners[corner];
    if (index >= vertex_count) {
      return invalid(fmt::format("corner {} of its faces refers to vertex {}, but there are {}",
                                 corner, index, vertex_count));
    }
    mesh.corner_vertices.push_back(first_vertex + static_cast<int>(index));
    mesh.corner_uvs.push_back(first_uv < 0 ? -1 : first_uv + static_cast<int>(index));
  }
  return {};
}

// Appends the shading of a submesh's faces, for the given corners.
void append_shading(const Submesh& submesh, std::span<const int> corner_vertices, int first_vertex,
                    Shading& shading) {
  const auto first_normal = static_cast<int>(shading.normals.size());
  const bool has_normals = !submesh.normals.empty();
  for (const int vertex : corner_vertices)
    shading.corner_normals.push_back(has_normals ? first_normal + vertex - first_vertex : -1);
  shading.smoothing.resize(shading.smoothing.size() + submesh.sizes.size(), Shading::unsaid);
  for (std::size_t k = 0; k + 3 <= submesh.normals.size(); k += 3) {
    const std::array<double, 3> normal = {submesh.normals[k], submesh.normals[k + 1],
                                          submesh.normals[k + 2]};
    const bool is_finite =
        std::all_of(normal.begin(), normal.end(), [](double each) { return std::isfinite(each); });
    shading.normals.push_back(is_finite ? normal : std::array<double, 3>{});
  }
}

Result<Mesh> merged(const MeshMessage& message, int uv_set, const StopRequest& should_stop) {
  if (auto checked = check_sets(message, uv_set); !checked) return fail(checked.error());
  if (auto checked = check_size(message); !checked) return fail(checked.error());
  Mesh mesh;
  Shading shading;
  NamedFaces materials;
  std::size_t numbers = 0;
  for (const Submesh& submesh : message.submeshes) numbers += submesh.positions.size();
  mesh.positions.resize(static_cast<Eigen::Index>(numbers / 3), 3);
  Eigen::Index row = 0;
  for (const Submesh& submesh : message.submeshes) {
    if (is_stopped(should_stop)) return interrupted();
    const int first_uv = submesh.uvs.empty() ? -1 : static_cast<int>(mesh.uvs.size());
    const auto first_vertex = static_cast<int>(row);
    const std::size_t first_corner = mesh.corner_vertices.size();
    if (auto added = append_faces(submesh, first_vertex, first_uv, mesh); !added)
      return fail(added.error());
    append_shading(submesh, std::span(mesh.corner_vertices).subspan(first_corner), first_vertex,
                   shading);
    materials.add_faces(materials.number_of(submesh.material), submesh.sizes.size());
    for (std::size_t k = 0; k + 3 <= submesh.positions.size(); k += 3, ++row)
      mesh.positions.row(row) << submesh.positions[k], submesh.positions[k + 1],
          submesh.positions[k + 2];
    for (std::size_t k = 0; k + 2 <= submesh.uvs.size(); k += 2)
      mesh.uvs.push_back({submesh.uvs[k], submesh.uvs[k + 1]});
  }
  mesh.materials = part_of(materials.names(), 0, mesh.face_sizes.size());
  const ObjectEntry& object = message.objects[*message.chosen];
  mesh.object = object.node.empty() ? object.mesh : object.node;
  LeftOut left_out;
  left_out.add(small_face, small_faces, static_cast<std::int64_t>(object.left_out));
  left_out.add("(u,v) that is not a pair of numbers", "(u,v) that are not pairs of numbers",
               drop_invalid_uvs(mesh));
  mesh.left_out = left_out.text();
  if (auto checked = check_mesh(mesh, should_stop); !checked) return fail(checked.error());
  auto shared = shared_normals(mesh, shading, should_stop);
  if (!shared) return fail(shared.error());
  mesh.corner_normals = *std::move(shared);
  return mesh;
}

// The error for a process whose answer cannot be trusted.
Error reader_failed(const std::string& format, const std::string& what) {
  return {ErrorCode::InvalidInput,
          fmt::format("the {} reader {}: the file is broken or hostile", format, what)};
}

Error out_of_memory(const std::string& format, const BoxLimits& limits, std::size_t file_bytes) {
  if (limits.memory < box_limits(file_bytes, std::numeric_limits<std::size_t>::max()).memory) {
    return {ErrorCode::OutOfMemory,
            fmt::format("the {} reader needs more than the {} of memory left for it", format,
                        bytes_text(limits.memory))};
  }
  return reader_failed(format, fmt::format("needs more than {} of memory for a file of {}",
                                           bytes_text(limits.memory), bytes_text(file_bytes)));
}

Result<void> check_end(const BoxedEnd& end, const std::string& format, const BoxLimits& limits,
                       std::size_t file_bytes) {
  constexpr int not_loaded = 127;  // exit code of the dynamic linker
  switch (end.how) {
    case BoxedEnd::How::Killed:
      return fail(reader_failed(format, fmt::format("crashed on this file (signal {}, {})",
                                                    end.number, strsignal(end.number))));
    case BoxedEnd::How::TimedOut:
      return fail(reader_failed(
          format, fmt::format("did not finish within {:.0f} seconds", limits.seconds)));
    case BoxedEnd::How::TooLong:
      return fail(reader_failed(
          format, fmt::format("produced more than {} from this file of {}",
                              bytes_text(limits.answer_bytes), bytes_text(file_bytes))));
    case BoxedEnd::How::Exited:
      break;
  }
  if (end.number == boxed_done) return {};
  if (end.number == boxed_out_of_memory) return fail(out_of_memory(format, limits, file_bytes));
  if (end.number == not_loaded) {
    return fail(ErrorCode::Unreadable,
                fmt::format("the {} reader cannot start: is libassimp installed?", format));
  }
  return fail(reader_failed(format, fmt::format("failed with exit code {}", end.number)));
}

Result<MeshMessage> to_message(std::string_view answer, const std::string& format) {
  auto message = parse_mesh_message(answer);
  if (!message) return fail(reader_failed(format, "produced something that is not a mesh"));
  switch (message->kind) {
    case MessageKind::OtherFormat:
      return invalid(fmt::format("the file is not {}", format));
    case MessageKind::Refused:
      return invalid(fmt::format("the file cannot be read: {}", told_reason(message->reason)));
    case MessageKind::TooManyObjects:
      return invalid(fmt::format("the file has more than {} objects", most_objects));
    case MessageKind::Scene:
      break;
  }
  return *std::move(message);
}

Result<Mesh> to_mesh(std::string_view answer, const std::string& format, const std::string& object,
                     int uv_set, const StopRequest& should_stop) {
  const auto message = to_message(answer, format);
  if (!message) return fail(message.error());
  const Names names(*message);
  const auto chosen = choose_object(names.objects, names.meshes, object);
  if (!chosen) return fail(chosen.error());
  if (message->chosen != *chosen)
    return fail(reader_failed(format, "produced a different object from the one requested"));
  auto mesh = merged(*message, uv_set, should_stop);
  if (!mesh) return mesh;
  if (auto applied = to_file_space(message->to_file, *mesh); !applied) return fail(applied.error());
  if (auto checked = check_mesh(*mesh, should_stop); !checked) return fail(checked.error());
  return mesh;
}

Result<std::vector<FileObject>> to_objects(std::string_view answer, const std::string& format) {
  const auto message = to_message(answer, format);
  if (!message) return fail(message.error());
  const Names names(*message);
  std::vector<FileObject> objects;
  for (std::size_t k = 0; k < names.objects.size(); ++k) {
    const ObjectEntry& entry = message->objects[k];
    objects.push_back(
        {.name = std::string(names.objects[k]), .vertices = entry.vertices, .faces = entry.faces});
  }
  if (objects.empty()) return invalid("the file has no faces");
  set_choices(names.meshes, objects);
  return objects;
}

// The answer of the program, which is the same of two runs.
Result<std::string> answer_about(std::string_view program, const OpenFile& file,
                                 const std::string& object, int uv_set, const RunContext& context) {
  const auto file_bytes = static_cast<std::size_t>(file.size());
  if (file_bytes > largest_mesh_file) {
    return fail(ErrorCode::Unreadable, fmt::format("cannot read the file: it is larger than {} MiB",
                                                   largest_mesh_file >> 20));
  }
  const std::string ending = ending_of(file.name());
  const auto run = [&](const BoxLimits& box) {
    return run_boxed(program, {ending.substr(1), object, std::to_string(uv_set)}, file.descriptor(),
                     box, context.should_stop);
  };
  const BoxLimits box = box_limits(file_bytes, MemoryShare(context.memory).available());
  BoxLimits other_box = box;
  other_box.freed = 0x5a;
  auto other_run = std::async(std::launch::async, [&] { return run(other_box); });
  auto end = run(box), other_end = other_run.get();
  const std::string format = format_name(ending);
  for (const auto* each : {&end, &other_end}) {
    if (!*each) return fail(each->error());
    if (auto checked = check_end(**each, format, box, file_bytes); !checked)
      return fail(checked.error());
  }
  if (end->answer != other_end->answer)
    return fail(reader_failed(format, "produced two different meshes from this file"));
  return std::move(end->answer);
}

// What `read` makes of the answer, with the file in its error.
template <class Read>
auto about_file(std::string_view program, const OpenFile& file, const std::string& object,
                int uv_set, const RunContext& context, const Read& read)
    -> decltype(read(std::string(), std::string())) {
  using Made = decltype(read(std::string(), std::string()));
  return about_mesh_file(file.name(), [&]() -> Made {
    const auto answer = answer_about(program, file, object, uv_set, context);
    if (!answer) return fail(answer.error());
    return read(*answer, format_name(ending_of(file.name())));
  });
}

std::string_view embedded_program() {
  return {reinterpret_cast<const char*>(mesh_reader_program.data()), mesh_reader_program.size()};
}

}  // namespace

BoxLimits box_limits(std::size_t file_bytes, std::size_t max_memory) {
  // The libraries need 60 MB of address space; a number of 8 bytes of text becomes a token of 100.
  constexpr std::size_t least = std::size_t{512} << 20, of_a_byte = 40;
  const std::size_t memory = std::max(least, std::min(max_memory, least + of_a_byte * file_bytes));
  // Of the 200 bytes that assimp needs for a corner of a face, 40 are in the answer.
  return {memory, 60 + 1e-6 * static_cast<double>(file_bytes), memory / 4};
}

Result<Mesh> read_boxed(std::string_view program, const OpenFile& file, const std::string& object,
                        int uv_set, const RunContext& context) {
  PLIANT_EXPECTS(uv_set >= 0 && uv_set < max_uv_sets);
  return about_file(program, file, object, uv_set, context,
                    [&](const std::string& answer, const std::string& format) {
                      return to_mesh(answer, format, object, uv_set, context.should_stop);
                    });
}

Result<Mesh> read_assimp(const std::filesystem::path& file, const std::string& object, int uv_set,
                         const RunContext& context) {
  const auto opened = OpenFile::open(file);
  if (!opened) return fail(opened.error());
  return read_assimp(*opened, object, uv_set, context);
}

Result<Mesh> read_assimp(const OpenFile& file, const std::string& object, int uv_set,
                         const RunContext& context) {
  return read_boxed(embedded_program(), file, object, uv_set, context);
}

Result<std::vector<FileObject>> assimp_objects(const std::filesystem::path& file,
                                               const RunContext& context) {
  const auto opened = OpenFile::open(file);
  if (!opened) return fail(opened.error());
  return about_file(embedded_program(), *opened, {}, 0, context, to_objects);
}

}  // namespace pliant
