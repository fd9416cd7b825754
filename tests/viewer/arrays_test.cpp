#include "viewer/arrays.hpp"

#include <random>
#include <vector>

#include <zlib.h>

#include "support/catch.hpp"

using namespace pliant;
using pliant::viewer::deflated;

namespace {

// The bytes of a raw stream, unpacked by zlib.
std::string inflated(const std::string& packed, std::size_t size) {
  std::string bytes(size + 1, '\0');  // one more, to detect a longer result
  z_stream stream = {};
  REQUIRE(inflateInit2(&stream, -15) == Z_OK);
  std::string source = packed;
  stream.next_in = reinterpret_cast<Bytef*>(source.data());
  stream.avail_in = static_cast<uInt>(source.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(bytes.size());
  CHECK(inflate(&stream, Z_FINISH) == Z_STREAM_END);
  CHECK(stream.avail_in == 0);
  bytes.resize(bytes.size() - stream.avail_out);
  inflateEnd(&stream);
  return bytes;
}

}  // namespace

TEST_CASE("deflating ends when asked", "[view]") {
  std::mt19937 random(3);
  std::string noise;
  for (int k = 0; k < 1'000'000; ++k) noise.push_back(static_cast<char>(random()));
  int asked = 0;
  REQUIRE(deflated(noise, [&] { return ++asked < 0; }));
  CHECK(asked > 10);
  for (int moment = 1; moment <= asked; ++moment) {
    int left = moment;
    const auto ended = deflated(noise, [&] { return --left == 0; });
    REQUIRE_FALSE(ended);
    CHECK(ended.error().code == ErrorCode::Interrupted);
  }
}

TEST_CASE("what is deflated inflates to what it was", "[view]") {
  std::mt19937 random(3);
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{1}, std::size_t{65536}, std::size_t{1'000'003}}) {
    std::string noise, calm(size, 'a');
    for (std::size_t k = 0; k < size; ++k) noise.push_back(static_cast<char>(random()));
    for (const std::string& bytes : {noise, calm}) {
      const auto packed = deflated(bytes);
      REQUIRE(packed);
      CHECK(inflated(*packed, size) == bytes);
    }
    CHECK(deflated(calm)->size() < size / 100 + 64);
  }
}
