// Arbitrary bytes as an OBJ, and as its object "a".

#include "pliant/files/obj/read_obj.hpp"

#include "fuzz.hpp"

using namespace pliant;
using namespace pliant::fuzzing;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  for (const char* const object : {"", "a"}) {
    check_read(parse_obj(text_of(bytes, size), "fuzz", object), 20);
  }
  return 0;
}
