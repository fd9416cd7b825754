#include "pliant/core/base64.hpp"

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("base 64 is that of RFC 4648", "[core][base64]") {
  CHECK(base64("").empty());
  CHECK(base64("f") == "Zg==");
  CHECK(base64("fo") == "Zm8=");
  CHECK(base64("foo") == "Zm9v");
  CHECK(base64("foob") == "Zm9vYg==");
  CHECK(base64("fooba") == "Zm9vYmE=");
  CHECK(base64("foobar") == "Zm9vYmFy");
  CHECK(base64(std::string("\xff\xfe\x00\xfb", 4)) == "//4A+w==");
}

TEST_CASE("base 64 is read as it is written, and nothing else", "[core][base64]") {
  const StopRequest never;
  StopPoll poll(never);
  std::string bytes;
  for (int k = 0; k < 300; ++k) {
    CHECK(from_base64(base64(bytes), poll) == bytes);
    bytes += static_cast<char>(7 * k);
  }
  for (const char* const text : {"Z", "Zg", "Zg=", "Zh==", "Zm9=", "Zg==Zg==", "Z===", "====",
                                 "Zm9v\n", "Zm-v", "Zm 9", "=Zm9"})
    CHECK_FALSE(from_base64(text, poll));
}
