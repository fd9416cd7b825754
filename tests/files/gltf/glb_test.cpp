#include "pliant/files/gltf/glb.hpp"

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("the head of a .glb says how long its parts are", "[output][glb]") {
  CHECK(glb_head("{}", 0) == std::string("glTF\2\0\0\0\x18\0\0\0\4\0\0\0JSON{}  ", 24));
  CHECK(glb_head("{\"a\"}", 8) ==
        std::string("glTF\2\0\0\0\x2c\0\0\0\x8\0\0\0JSON{\"a\"}   \x8\0\0\0BIN\0", 36));
}

TEST_CASE("a .glb has at most as many bytes as its length can say", "[output][glb]") {
  const std::uint64_t head = 12 + 8 + 4 + 8;
  const std::uint64_t most = (most_glb_bytes - head) / 4 * 4;
  CHECK(glb_head("{}", most).has_value());
  CHECK_FALSE(glb_head("{}", most + 4).has_value());
}
