// Arbitrary bytes as a PLY.

#include "pliant/files/ply/read_ply.hpp"

#include "fuzz.hpp"

using namespace pliant;
using namespace pliant::fuzzing;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  check_read(parse_ply(text_of(bytes, size), "fuzz"));
  return 0;
}
