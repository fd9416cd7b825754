#include "viewer/lines.hpp"

#include <cstring>

#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::viewer;

namespace {

SurfaceLines between(int vertex, int other, double share) {
  SurfaceLines lines;
  lines.add_source(vertex, 1);
  lines.add_point();
  lines.add_source(vertex, 1 - share);
  lines.add_source(other, share);
  lines.add_point();
  lines.segments.push_back({0, 1});
  return lines;
}

}  // namespace

TEST_CASE("lines that come again are packed once", "[viewer][lines]") {
  PackedLines packed;
  CHECK(packed.is_empty());
  CHECK(packed.add(between(3, 4, 0.25)) == Json({0, 2, 0, 1}));
  CHECK(packed.add(between(3, 4, 0.5)) == Json({2, 2, 1, 1}));
  CHECK(packed.add(between(3, 4, 0.25)) == Json({0, 2, 0, 1}));
  CHECK(packed.add(between(3, 5, 0.25)) == Json({4, 2, 2, 1}));
  CHECK_FALSE(packed.is_empty());
  Arrays arrays;
  const Json places = packed.arrays(arrays);
  const std::string bytes = arrays.take();
  CHECK(places["counts"]["count"] == 6);
  CHECK(places["segments"]["count"] == 6);
  REQUIRE(places["shares"]["count"] == 9);
  std::array<float, 9> shares;
  std::memcpy(shares.data(), bytes.data() + places["shares"]["begin"].get<std::size_t>(),
              sizeof(shares));
  CHECK(shares == std::array<float, 9>{1, 0.75f, 0.25f, 1, 0.5f, 0.5f, 1, 0.75f, 0.25f});
  std::array<std::int32_t, 9> sources;
  std::memcpy(sources.data(), bytes.data() + places["sources"]["begin"].get<std::size_t>(),
              sizeof(sources));
  CHECK(sources == std::array<std::int32_t, 9>{3, 3, 4, 3, 3, 4, 3, 3, 5});
}
