#include "pliant/files/gltf/read_gltf.hpp"

#include <new>
#include <set>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/files/boxed/read_assimp.hpp"
#include "pliant/files/file_object.hpp"
#include "pliant/files/file_reference.hpp"
#include "pliant/files/gltf/gltf_accessor.hpp"
#include "pliant/files/gltf/gltf_buffers.hpp"
#include "pliant/files/gltf/gltf_container.hpp"
#include "pliant/files/gltf/gltf_document.hpp"
#include "pliant/files/gltf/gltf_object.hpp"
#include "pliant/files/gltf/gltf_scene.hpp"
#include "pliant/files/open_file.hpp"
#include "pliant/files/read_file.hpp"

namespace pliant {
namespace {

namespace fs = std::filesystem;
using namespace gltf;

// Errors do not name the file.
Result<Mesh> parse(std::string_view bytes, const ReadReference& read_reference,
                   const IdentifyReference& identify, const std::string& name, int uv_set,
                   std::span<const std::string> attributes, const StopRequest& should_stop) {
  const auto container = open_container(bytes);
  if (!container) return fail(container.error());
  const auto document = read_document(container->json, Subject::Meshes, should_stop);
  if (!document) return fail(document.error());
  const auto objects = objects_of(*document, should_stop);
  if (!objects) return fail(objects.error());
  const auto object = choose(*document, *objects, name);
  if (!object) return fail(object.error());
  Buffers buffers(*document, container->binary, bytes.size(), read_reference, identify,
                  should_stop);
  AccessorReader accessors(*document, buffers, should_stop);
  return mesh_of(*document, *object, accessors, uv_set, attributes, should_stop);
}

std::vector<std::string> uris_in(std::string_view bytes, const StopRequest& should_stop) {
  const auto container = open_container(bytes);
  if (!container) return {};
  const auto document = read_document(container->json, Subject::Meshes, should_stop);
  if (!document) return {};
  std::vector<std::string> uris;
  for (const gltf::Buffer& buffer : document->buffers)
    if (buffer.uri && !is_data(*buffer.uri)) uris.push_back(*buffer.uri);
  return uris;
}

}  // namespace

Result<Mesh> parse_gltf(std::string_view bytes, const std::string& name,
                        const ReadReference& read_reference, const std::string& object, int uv_set,
                        std::span<const std::string> attributes, const StopRequest& should_stop) {
  PLIANT_EXPECTS(uv_set >= 0 && uv_set < max_uv_sets);
  return about_mesh_file(name, [&] {
    return parse(bytes, read_reference, {}, object, uv_set, attributes, should_stop);
  });
}

Result<Mesh> read_gltf(const OpenFile& file, const std::string& object, int uv_set,
                       const fs::path& root, std::span<const std::string> attributes,
                       const StopRequest& should_stop) {
  PLIANT_EXPECTS(uv_set >= 0 && uv_set < max_uv_sets);
  const auto bytes = read_file(file, largest_mesh_file, should_stop);
  if (!bytes) return fail(bytes.error());
  const auto read = [&](const std::string& uri, std::size_t max_bytes) {
    return read_reference(uri, file.name(), root, max_bytes, should_stop);
  };
  const auto identify = [&](const std::string& uri) {
    const auto found = find_reference(uri, file.name(), root);
    return found ? found->string() : uri;
  };
  return about_mesh_file(file.name(), [&] {
    return parse(*bytes, read, identify, object, uv_set, attributes, should_stop);
  });
}

Result<std::vector<FileObject>> gltf_objects(const fs::path& file, const StopRequest& should_stop) {
  const auto bytes = read_file(file, largest_mesh_file, should_stop);
  if (!bytes) return fail(bytes.error());
  return about_mesh_file(file.string(), [&]() -> Result<std::vector<FileObject>> {
    const auto container = open_container(*bytes);
    if (!container) return fail(container.error());
    const auto document = read_document(container->json, Subject::Meshes, should_stop);
    if (!document) return fail(document.error());
    const auto objects = objects_of(*document, should_stop);
    if (!objects) return fail(objects.error());
    if (objects->empty()) return invalid("the file has no faces");
    return listed(*document, *objects);
  });
}

std::vector<fs::path> gltf_references(const OpenFile& file, const fs::path& root,
                                      const StopRequest& should_stop) {
  const auto bytes = read_file(file, largest_mesh_file, should_stop);
  if (!bytes) return {};
  std::vector<fs::path> files;
  try {
    std::set<fs::path> known;
    for (const std::string& uri : uris_in(*bytes, should_stop)) {
      auto found = find_reference(uri, file.name(), root);
      if (found && known.insert(*found).second) files.push_back(*std::move(found));
    }
  } catch (const std::bad_alloc&) {  // read_gltf reports it
  }
  return files;
}

}  // namespace pliant
