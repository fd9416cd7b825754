#include "pliant/files/read_mesh.hpp"

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pliant/core/memory_budget.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/boxed/read_assimp.hpp"
#include "pliant/files/file_object.hpp"
#include "pliant/files/gltf/read_gltf.hpp"
#include "pliant/files/mesh_objects.hpp"
#include "pliant/files/obj/read_obj.hpp"
#include "pliant/files/open_file.hpp"
#include "pliant/files/opened_mesh.hpp"
#include "pliant/files/ply/read_ply.hpp"
#include "pliant/files/read_file.hpp"

namespace pliant {
namespace {

// For a format with at most one set of (u,v).
Result<Mesh> with_only_set(Result<Mesh> mesh, const std::filesystem::path& file, int uv_set) {
  if (!mesh) return mesh;
  const auto checked = check_uv_set(uv_set, mesh->uvs.empty() ? 0 : 1);
  if (checked) return mesh;
  return fail(checked.error().code, checked.error().message, file.string());
}

Result<void> check_mesh_ending(const std::filesystem::path& file) {
  const std::vector<std::string> endings = mesh_endings();
  if (std::ranges::find(endings, ending_of(file)) != endings.end()) return {};
  return invalid(fmt::format("no mesh format has the ending of {}; allowed: {}", file.string(),
                             fmt::join(endings, ", ")));
}

bool is_gltf(std::string_view ending) { return ending == ".gltf" || ending == ".glb"; }

}  // namespace

std::vector<std::string> mesh_endings() {
  return {".obj", ".ply", ".gltf", ".glb", ".fbx", ".dae"};
}

Result<Mesh> read_mesh(const std::string& file, const std::string& object, int uv_set,
                       std::span<const std::string> attributes, const StopRequest& should_stop) {
  if (auto known = check_mesh_ending(file); !known) return fail(known.error());
  if (uv_set < 0 || uv_set >= max_uv_sets) {
    return fail(
        ErrorCode::InvalidInput,
        fmt::format("the set of (u,v) is {}, but must be from 0 to {}", uv_set, max_uv_sets - 1),
        file);
  }
  const auto opened = OpenFile::open(file);
  if (!opened) return fail(opened.error());
  return read_mesh(*opened, object, uv_set, {}, {.should_stop = should_stop}, attributes);
}

Result<Mesh> read_mesh(const OpenFile& file, const std::string& object, int uv_set,
                       const std::filesystem::path& root, const RunContext& context,
                       std::span<const std::string> attributes) {
  const std::string& name = file.name();
  if (auto known = check_mesh_ending(name); !known) return fail(known.error());
  const std::string ending = ending_of(name);
  if (!attributes.empty() && ending != ".ply" && !is_gltf(ending)) {
    return fail(
        ErrorCode::InvalidInput,
        fmt::format("a mesh of the format {} has no attribute {}; only .ply, .gltf and .glb "
                    "have numbers at vertices",
                    ending, in_quotes(attributes.front())),
        name);
  }
  const StopRequest& should_stop = context.should_stop;
  if (ending == ".obj" || ending == ".ply") {
    const auto bytes = read_file(file, largest_mesh_file, should_stop);
    if (!bytes) return fail(bytes.error());
    auto mesh = ending == ".obj" ? parse_obj(*bytes, name, object, should_stop)
                                 : parse_ply(*bytes, name, object, attributes, should_stop);
    return with_only_set(std::move(mesh), name, uv_set);
  }
  if (is_gltf(ending)) return read_gltf(file, object, uv_set, root, attributes, should_stop);
  return read_assimp(file, object, uv_set, context);
}

Result<std::vector<FileObject>> mesh_objects(const std::filesystem::path& file,
                                             const RunContext& context) {
  if (auto known = check_mesh_ending(file); !known) return fail(known.error());
  const std::string ending = ending_of(file);
  MemoryShare memory(context.memory);
  if (ending != ".fbx" && ending != ".dae") {  // for which it is measured
    std::error_code unknown;                   // if there is no file, reading it tells that
    const std::uintmax_t size = std::filesystem::file_size(file, unknown);
    const std::size_t bytes = unknown ? 0 : bytes_to_read_byte * static_cast<std::size_t>(size);
    if (!memory.try_resize(bytes))
      return fail(ErrorCode::OutOfMemory, "the mesh " + memory.complaint(bytes), file.string());
  }
  if (ending == ".obj") return obj_objects(file, context.should_stop);
  if (ending == ".ply") return ply_objects(file, context.should_stop);
  return is_gltf(ending) ? gltf_objects(file, context.should_stop) : assimp_objects(file, context);
}

std::vector<std::filesystem::path> mesh_references(const OpenFile& file,
                                                   const std::filesystem::path& root,
                                                   const StopRequest& should_stop) {
  return is_gltf(ending_of(file.name())) ? gltf_references(file, root, should_stop)
                                         : std::vector<std::filesystem::path>();
}

}  // namespace pliant
