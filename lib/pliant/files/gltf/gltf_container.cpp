#include "pliant/files/gltf/gltf_container.hpp"

#include <cstdint>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/byte_order.hpp"

namespace pliant::gltf {
namespace {

constexpr std::size_t header_size = 12, chunk_header_size = 8;
constexpr std::uint64_t json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;

// Requires: four bytes at `at`.
std::uint64_t number_at(std::string_view bytes, std::size_t at) {
  return number_from<std::uint32_t>(bytes.data() + at);
}

}  // namespace

Result<Container> open_container(std::string_view bytes) {
  if (!bytes.starts_with("glTF")) return Container{bytes};
  if (bytes.size() < header_size)
    return invalid("the file is truncated: it ends within its header");
  if (const auto version = number_at(bytes, 4); version != 2)
    return invalid(
        fmt::format("the file is glTF version {}; only version 2 is supported", version));
  if (const auto length = number_at(bytes, 8); length != bytes.size()) {
    return invalid(fmt::format("the file {}: it has {} of {} bytes",
                               length > bytes.size() ? "is truncated" : "has data after its end",
                               bytes.size(), length));
  }
  std::optional<std::string_view> json, binary;
  for (std::size_t at = header_size; at < bytes.size();) {
    const std::size_t room = bytes.size() - at;
    if (room < chunk_header_size || number_at(bytes, at) > room - chunk_header_size)
      return invalid(fmt::format("the chunk at byte {} reaches past the end of the file", at));
    const auto size = static_cast<std::size_t>(number_at(bytes, at));
    const std::uint64_t kind = number_at(bytes, at + 4);
    const std::string_view content = bytes.substr(at + chunk_header_size, size);
    if (!json && kind != json_chunk) return invalid("the file's first chunk is not JSON");
    if (!json) {
      json = content;
    } else if (kind == binary_chunk && !binary) {
      binary = content;
    }  // chunks of other types are unknown but allowed
    at += chunk_header_size + size;
  }
  if (!json) return invalid("the file has no JSON");
  return Container{*json, binary};
}

}  // namespace pliant::gltf
