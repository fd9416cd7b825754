// Arbitrary bytes as a glTF: the result is a valid mesh or a one-line error.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "pliant/mesh/mesh.hpp"
#include "pliant/mesh/read_gltf.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace pliant;
  const std::string_view text(reinterpret_cast<const char*>(bytes), size);
  const auto read = [](const std::string& uri, std::size_t) -> Result<std::string> {
    return std::string(uri.size() % 200, 'x');
  };
  for (const int uv_set : {0, 1}) {
    const auto mesh = parse_gltf(text, "fuzz", read, "", uv_set);
    if (mesh && !check_mesh(*mesh)) std::abort();
    if (mesh && !mesh->positions.allFinite()) std::abort();
    if (!mesh && to_lines(mesh.error()).size() != 1) std::abort();
  }
  return 0;
}
