#include "pliant/core/hash.hpp"

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("a hash is that of the xxhsum program", "[core][hash]") {
  // Published test values of XXH3, 128 bits, seed 0: of the empty text, and of the letter a.
  CHECK(to_text(hash_of("")) == "99aa06d3014798d86001c324468d497f");
  CHECK(to_text(hash_of("a")) == "a96faf705af16834e6c632b61e964e1f");
}

TEST_CASE("hashes are read as they are written", "[core][hash]") {
  for (const char* text : {"", "a", "pliant"}) {
    const Hash hash = hash_of(text);
    CHECK(to_hash(to_text(hash)) == hash);
  }
  const std::string sound = to_text(hash_of("a"));
  CHECK(to_hash(sound));
  for (const std::string& other :
       {std::string(), sound.substr(1), sound + "0", "+" + sound.substr(1), "G" + sound.substr(1),
        "A" + sound.substr(1)}) {
    CHECK_FALSE(to_hash(other));
  }
}

TEST_CASE("the hash of a field tells every bit of it", "[core][hash]") {
  Field field = Field::Zero(5, 3);
  const Hash zero = hash_of(field);
  for (Eigen::Index row = 0; row < 5; ++row) {
    for (Eigen::Index component = 0; component < 3; ++component) {
      Field other = field;
      other(row, component) = -0.0;
      CHECK(hash_of(other) != zero);
      other(row, component) = 5e-324;
      CHECK(hash_of(other) != zero);
    }
  }
  field.resize(4, 3);
  field.setZero();
  CHECK(hash_of(field) != zero);
}
