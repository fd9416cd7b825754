#include "pliant/core/byte_order.hpp"

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("numbers have the bytes of their order", "[core][byte_order]") {
  std::string bytes;
  append_number(bytes, std::uint32_t{0x01020304});
  append_number(bytes, std::uint32_t{0x01020304}, std::endian::big);
  append_number(bytes, std::int16_t{-2}, std::endian::big);
  append_number(bytes, 1.0F);
  CHECK(bytes == std::string("\4\3\2\1\1\2\3\4\xff\xfe\0\0\x80\x3f", 14));
  CHECK(number_from<std::uint32_t>(bytes.data()) == 0x01020304);
  CHECK(number_from<std::uint32_t>(bytes.data() + 4, std::endian::big) == 0x01020304);
  CHECK(number_from<std::int16_t>(bytes.data() + 8, std::endian::big) == -2);
  CHECK(number_from<float>(bytes.data() + 10) == 1);
  CHECK(bits_from(bytes.data(), 3) == 0x020304);
  CHECK(bits_from(bytes.data() + 4, 3, std::endian::big) == 0x010203);
}
