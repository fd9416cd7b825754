// Arbitrary bytes as a point cache: the first one selects the format, the others are the file.

#include <array>
#include <string>
#include <utility>

#include "fuzz.hpp"
#include "pliant/files/caches/point_cache.hpp"

using namespace pliant;
using namespace pliant::fuzzing;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  constexpr std::array names = {"fuzz.pc2", "fuzz.mdd", "fuzz.npy"};
  if (size == 0) return 0;
  const auto cache =
      PointCache::of_bytes(std::string(text_of(bytes + 1, size - 1)), names[bytes[0] % 3]);
  if (!cache) {
    check_error(cache.error());
    return 0;
  }
  require(cache->sample_count() > 0 && cache->vertex_count() > 0);
  for (const double fps : {24.0, 1e-300, 1e300}) {
    const auto frames = cache->frames({}, 1, fps);
    if (!frames) {
      check_error(frames.error());
      continue;
    }
    require(frames->size() == static_cast<std::size_t>(cache->sample_count()));
    for (std::size_t k = 1; k < frames->size(); ++k) require((*frames)[k] > (*frames)[k - 1]);
  }
  // All that the head promises is there.
  for (int sample = 0; sample < cache->sample_count(); ++sample) {
    const auto positions = cache->read(sample);
    require(positions && positions->rows() == cache->vertex_count());
  }
  return 0;
}
