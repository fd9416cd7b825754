#include "pliant/states/sealed_bytes.hpp"

#include "support/catch.hpp"

using namespace pliant;

namespace {

constexpr std::string_view magic = "some bytes 1\n";

std::string sealed() {
  std::string bytes(magic);
  append(bytes, std::uint64_t{0x0102030405060708});
  append(bytes, Hash{3, 4});
  append_seal(bytes);
  return bytes;
}

}  // namespace

TEST_CASE("sealed bytes are read as they were appended", "[states][sealed_bytes]") {
  const std::string bytes = sealed();
  const auto held = unsealed(bytes, magic);
  REQUIRE(held);
  CHECK(held->front() == 8);  // little-endian
  ByteReader reader(*held);
  CHECK(reader.number() == 0x0102030405060708);
  CHECK(reader.hash() == Hash{3, 4});
  CHECK(reader.is_sound());
  CHECK(reader.left() == 0);
}

TEST_CASE("every flipped bit, cut and addition breaks the seal", "[states][sealed_bytes]") {
  const std::string whole = sealed();
  for (std::size_t place = 0; place < whole.size(); ++place) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string flipped = whole;
      flipped[place] = static_cast<char>(flipped[place] ^ 1 << bit);
      CHECK_FALSE(unsealed(flipped, magic));
    }
    CHECK_FALSE(unsealed(whole.substr(0, place), magic));
  }
  CHECK_FALSE(unsealed(whole + '\0', magic));
  CHECK_FALSE(unsealed(whole, "some bytes 2\n"));
}

TEST_CASE("what is not there is taken as nothing, and told", "[states][sealed_bytes]") {
  ByteReader reader("seven b");
  CHECK(reader.number() == 0);
  CHECK_FALSE(reader.is_sound());
  CHECK(reader.left() == 7);

  ByteReader other("seven b");
  CHECK(other.take(7) == "seven b");
  CHECK(other.take(0).empty());
  CHECK(other.is_sound());
  CHECK(other.take(~std::uint64_t{0}).empty());
  CHECK_FALSE(other.is_sound());
}
