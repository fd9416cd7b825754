#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/files/caches/cache_layout.hpp"
#include "pliant/mesh/shape_samples.hpp"

namespace pliant {

/// The positions of a mesh's vertices at some times, its samples: in a file, .pc2, .mdd or .npy, of
/// which only what is asked for is read, or in memory. Thread-safe.
class PointCache {
 public:
  /// Reads how the file is laid out. Errors: those of `OpenFile::open`; InvalidInput as
  /// `read_layout`, or for a name that ends in none of the three.
  static Result<PointCache> open(const std::filesystem::path& file,
                                 const std::filesystem::path& root = {});

  /// The same for the bytes of a file with this name.
  static Result<PointCache> of_bytes(std::string bytes, const std::filesystem::path& file);

  /// The same for samples in memory, one frame apart. Errors: InvalidInput, naming the sample: it
  /// has no vertices, or not as many as the first. Requires: there are samples.
  static Result<PointCache> of_samples(ShapeSamples samples);

  int vertex_count() const { return layout_.vertex_count; }
  int sample_count() const { return layout_.sample_count; }

  /// The frame of each sample, ascending: `first` that of the first one; null: a .pc2 has its own,
  /// the others begin at `start`. A time that is a whole frame within the single precision of the
  /// file is that frame. Errors: InvalidInput if two samples have one time, or one is not finite.
  Result<std::vector<double>> frames(std::optional<double> first, int start, double fps) const;

  /// #vertices x 3, in the memory of `reuse`; any numbers, NaN too. Errors: Unreadable. Requires: 0
  /// <= sample < sample_count().
  Result<Field> read(int sample, Field reuse = {}) const;

  const std::string& file() const { return file_; }  ///< empty: it is in memory

  /// The memory that its samples take. [bytes]
  std::size_t bytes() const { return samples_.bytes(); }

 private:
  PointCache(std::string file, std::shared_ptr<const CacheBytes> bytes, CacheLayout layout);

  std::string file_;
  std::shared_ptr<const CacheBytes> bytes_;  // null: it has samples
  ShapeSamples samples_;
  CacheLayout layout_;
};

}  // namespace pliant
