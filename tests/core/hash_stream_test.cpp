#include "pliant/core/hash_stream.hpp"

#include <string>

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("pieces have the hash of the whole", "[core][hash]") {
  std::string bytes;
  for (int k = 0; k < 5000; ++k) bytes += static_cast<char>(k * k % 251);
  const std::size_t size = GENERATE(1, 7, 256, 1000, 5000);
  HashStream stream;
  for (std::size_t at = 0; at < bytes.size(); at += size)
    stream.add(std::string_view(bytes).substr(at, size));
  CHECK(stream.hash() == hash_of(bytes));
  CHECK(HashStream().hash() == hash_of(""));
}
