#include "pliant/files/gltf/glb.hpp"

#include "pliant/core/byte_order.hpp"
#include "pliant/core/expects.hpp"

namespace pliant {

std::optional<std::string> glb_head(std::string json, std::uint64_t number_bytes) {
  PLIANT_EXPECTS(number_bytes % 4 == 0);
  json.append((4 - json.size() % 4) % 4, ' ');
  const std::uint64_t length = 12 + 8 + json.size() + (number_bytes == 0 ? 0 : 8 + number_bytes);
  if (length > most_glb_bytes) return {};
  std::string head = "glTF";
  const auto append = [&](std::uint64_t number) {
    append_number(head, static_cast<std::uint32_t>(number));
  };
  append(2);
  append(length);
  append(json.size());
  head += "JSON" + json;
  if (number_bytes == 0) return head;
  append(number_bytes);
  return head.append("BIN\0", 4);
}

}  // namespace pliant
