#pragma once

#include <algorithm>
#include <bit>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "files/mesh_files.hpp"
#include "pliant/files/gltf/read_gltf.hpp"
#include "support/catch.hpp"

namespace pliant::testing {

inline const std::string cloth_node = R"({"name":"cloth","mesh":0})";

inline std::string gltf_mesh(const std::string& primitives, const std::string& name = "weave") {
  return fmt::format("{{\"name\":\"{}\",\"primitives\":[{}]}}", name, primitives);
}

/// Parses from a buffer of exactly that size, so that a sanitizer detects any read beyond it.
inline Result<Mesh> parse_exactly(std::string_view bytes, const std::string& object = {},
                                  int uv_set = 0, const ReadReference& read_reference = {}) {
  const std::unique_ptr<char[]> memory(new char[bytes.size()]);
  std::copy(bytes.begin(), bytes.end(), memory.get());
  return parse_gltf({memory.get(), bytes.size()}, "a.gltf", read_reference, object, uv_set);
}

/// The one-line error for a glTF; "none": it can be read.
inline std::string gltf_complaint(std::string_view bytes, const std::string& object = {},
                                  int uv_set = 0, const ReadReference& read_reference = {}) {
  const auto mesh = parse_exactly(bytes, object, uv_set, read_reference);
  if (mesh) return "none";
  CHECK(to_lines(mesh.error()).size() == 1);
  CHECK(to_lines(mesh.error()).front().find('\n') == std::string::npos);
  return to_lines(mesh.error()).front();
}

/// A glTF assembled by hand: each part as JSON without its brackets, and the bytes of its only
/// buffer.
struct GltfParts {
  std::string accessors, views, primitives;
  std::string bytes;
  std::string nodes = cloth_node;
  std::string more = {};  ///< further members of the file, with a comma after them

  std::string text() const {
    return fmt::format(
        "{{\"asset\":{{\"version\":\"2.0\"}},{}\"scene\":0,\"scenes\":[{{\"nodes\":[0]}}],"
        "\"nodes\":[{}],\"meshes\":[{{\"primitives\":[{}]}}],\"accessors\":[{}],"
        "\"bufferViews\":[{}],\"buffers\":[{{\"byteLength\":{},\"uri\":\"data:;base64,{}\"}}]}}",
        more, nodes, primitives, accessors, views, bytes.size(), base64(bytes));
  }
};

inline std::string floats(std::initializer_list<float> numbers) {
  std::string bytes;
  for (const float number : numbers)
    bytes += little_endian(std::bit_cast<std::uint32_t>(number), 4);
  return bytes;
}

}  // namespace pliant::testing
