#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/files/gltf/gltf_buffers.hpp"
#include "pliant/files/gltf/gltf_document.hpp"

namespace pliant::gltf {

/// How many elements a file may have beyond its number of bytes. Accessors without bytes, and
/// several accessors of the same bytes, create elements without making the file larger.
inline constexpr std::size_t most_elements_beyond_bytes = 1'000'000;

/// Reads accessors. All results come from the buffers: every offset, count, stride and index is
/// checked against its buffer. `document` and `buffers` must outlive the reader.
class AccessorReader {
 public:
  AccessorReader(const Document& document, Buffers& buffers, StopRequest should_stop = {})
      : document_(document), buffers_(buffers), should_stop_(std::move(should_stop)) {}

  /// Vectors of a vertex attribute: VEC2 or VEC3 by `width`, `width` numbers per element. Floats
  /// keep their value; integers become numbers, or fractions of their largest value if normalized.
  Result<std::vector<double>> vectors(std::size_t accessor, int width);

  /// SCALAR, any numbers: one per element, as `vectors`.
  Result<std::vector<double>> scalars(std::size_t accessor);

  /// SCALAR, unsigned integers.
  Result<std::vector<std::uint32_t>> indices(std::size_t accessor);

  /// Counts the elements of an accessor as read, so that a file cannot create more elements than
  /// its bytes allow. Must be called when elements that were read before are used again. Errors:
  /// too many.
  Result<void> charge(std::size_t accessor);

 private:
  // Elements in a buffer, each `stride` bytes after the one before.
  struct StridedBytes {
    std::string_view bytes;  // from the first to the end of the last
    std::size_t stride;
  };
  struct Read;  // an accessor that is being read

  Result<std::vector<double>> read(const Read& read);
  Result<StridedBytes> strided_bytes(const Read& read, std::size_t view, std::uint64_t offset,
                                     std::uint64_t count, std::size_t element_size) const;
  Result<void> put_sparse(const Read& read, std::vector<double>& numbers, StopPoll& poll) const;
  const Document& document_;
  Buffers& buffers_;
  StopRequest should_stop_;
  std::uint64_t elements_read_ = 0;
};

}  // namespace pliant::gltf
