// Arbitrary bytes as a glTF.

#include "pliant/files/gltf/read_gltf.hpp"

#include "fuzz.hpp"

using namespace pliant;
using namespace pliant::fuzzing;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const auto read = [](const std::string& uri, std::size_t) -> Result<std::string> {
    return std::string(uri.size() % 200, 'x');
  };
  for (const int uv_set : {0, 1}) {
    check_read(parse_gltf(text_of(bytes, size), "fuzz", read, "", uv_set));
  }
  return 0;
}
