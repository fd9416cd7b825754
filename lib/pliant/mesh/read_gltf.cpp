#include "pliant/mesh/read_gltf.hpp"

#include <algorithm>
#include <new>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/core/open_file.hpp"
#include "pliant/core/read_file.hpp"
#include "pliant/mesh/file_reference.hpp"
#include "pliant/mesh/gltf_accessor.hpp"
#include "pliant/mesh/gltf_buffers.hpp"
#include "pliant/mesh/gltf_container.hpp"
#include "pliant/mesh/gltf_document.hpp"
#include "pliant/mesh/gltf_object.hpp"
#include "pliant/mesh/gltf_scene.hpp"
#include "pliant/mesh/read_assimp.hpp"

namespace pliant {
namespace {

namespace fs = std::filesystem;
using namespace gltf;

Result<Mesh> parse(std::string_view bytes, const ReadReference& read_reference,
                   const std::string& name, int uv_set, std::span<const std::string> attributes) {
  const auto container = open_container(bytes);
  if (!container) return fail(container.error());
  const auto document = read_document(container->json);
  if (!document) return fail(document.error());
  auto objects = objects_of(*document);
  if (!objects) return fail(objects.error());
  const auto object = choose(*std::move(objects), name);
  if (!object) return fail(object.error());
  Buffers buffers(*document, container->binary, bytes.size(), read_reference);
  AccessorReader accessors(*document, buffers);
  return mesh_of(*document, *object, accessors, uv_set, attributes);
}

std::vector<std::string> uris_in(std::string_view bytes) {
  const auto container = open_container(bytes);
  if (!container) return {};
  const auto document = read_document(container->json);
  if (!document) return {};
  std::vector<std::string> uris;
  for (const gltf::Buffer& buffer : document->buffers)
    if (buffer.uri && !is_data(*buffer.uri)) uris.push_back(*buffer.uri);
  return uris;
}

}  // namespace

Result<Mesh> parse_gltf(std::string_view bytes, const std::string& name,
                        const ReadReference& read_reference, const std::string& object, int uv_set,
                        std::span<const std::string> attributes) {
  PLIANT_EXPECTS(uv_set >= 0 && uv_set < max_uv_sets);
  try {
    auto mesh = parse(bytes, read_reference, object, uv_set, attributes);
    if (!mesh) mesh.error().file = name;
    return mesh;
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::OutOfMemory, "the mesh does not fit in memory", name);
  }
}

Result<Mesh> read_gltf(const fs::path& file, const std::string& object, int uv_set,
                       const fs::path& root, std::span<const std::string> attributes) {
  const auto opened = OpenFile::open(file);
  if (!opened) return fail(opened.error());
  return read_gltf(*opened, object, uv_set, root, attributes);
}

Result<Mesh> read_gltf(const OpenFile& file, const std::string& object, int uv_set,
                       const fs::path& root, std::span<const std::string> attributes) {
  const auto bytes = read_file(file);
  if (!bytes) return fail(bytes.error());
  const auto read = [&](const std::string& uri, std::size_t max_bytes) {
    return read_reference(uri, file.name(), root, max_bytes);
  };
  return parse_gltf(*bytes, file.name(), read, object, uv_set, attributes);
}

Result<std::vector<FileObject>> gltf_objects(const fs::path& file) {
  const auto bytes = read_file(file);
  if (!bytes) return fail(bytes.error());
  const auto list = [&]() -> Result<std::vector<FileObject>> {
    const auto container = open_container(*bytes);
    if (!container) return fail(container.error());
    const auto document = read_document(container->json);
    if (!document) return fail(document.error());
    const auto objects = objects_of(*document);
    if (!objects) return fail(objects.error());
    if (objects->empty()) return invalid("the file has no faces");
    return listed(*document, *objects);
  };
  try {
    auto objects = list();
    if (!objects) objects.error().file = file.string();
    return objects;
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::OutOfMemory, "the mesh does not fit in memory", file.string());
  }
}

std::vector<fs::path> gltf_references(const OpenFile& file, const fs::path& root) {
  const auto bytes = read_file(file);
  if (!bytes) return {};
  std::vector<fs::path> files;
  try {
    for (const std::string& uri : uris_in(*bytes)) {
      auto found = find_reference(uri, file.name(), root);
      if (found && std::find(files.begin(), files.end(), *found) == files.end())
        files.push_back(*std::move(found));
    }
  } catch (const std::bad_alloc&) {  // read_gltf reports it
  }
  return files;
}

}  // namespace pliant
