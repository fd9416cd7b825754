#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pliant/core/result.hpp"

namespace pliant {

// How a point cache is laid out in its file; internal to mesh.

/// The bytes of a cache, in a file or in memory.
class CacheBytes {
 public:
  virtual ~CacheBytes() = default;
  virtual std::uint64_t size() const = 0;

  /// Copies `count` bytes from `offset` on. Errors: Unreadable; they are not there.
  virtual Result<void> read(std::uint64_t offset, void* to, std::size_t count) const = 0;
};

struct CacheLayout {
  /// What the times are counted in.
  enum class Clock { Samples, Frames, Seconds };

  int vertex_count = 0;  ///< >= 1
  int sample_count = 0;  ///< >= 1
  Clock clock = Clock::Samples;
  double start = 0;                 ///< of Clock::Frames: the first sample [frames]
  double step = 1;                  ///< of Clock::Frames: from one sample to the next [frames], > 0
  std::vector<float> seconds = {};  ///< of Clock::Seconds: one a sample [s]

  std::uint64_t begin = 0;  ///< of the first number [bytes]
  bool is_double = false;   ///< the numbers, three a vertex, vertex by vertex, sample by sample
  std::endian byte_order = std::endian::little;

  std::size_t number_size() const { return is_double ? 8 : 4; }
  std::uint64_t sample_bytes() const {
    return std::uint64_t{3} * number_size() * static_cast<std::uint64_t>(vertex_count);
  }
};

/// The layout of the file with this name. Errors: Unreadable; InvalidInput for a name that ends in
/// none of .pc2, .mdd and .npy, for a head that breaks a rule of its format, and for fewer numbers
/// than the head promises; they name the file.
Result<CacheLayout> read_layout(const CacheBytes& bytes, const std::filesystem::path& file);

}  // namespace pliant
