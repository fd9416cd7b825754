#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/mesh/gltf_buffers.hpp"
#include "pliant/mesh/gltf_document.hpp"

namespace pliant::gltf {

/// Elements that a file may make out of nothing, by accessors without bytes or by several over the
/// same ones: so many more than it has bytes.
inline constexpr std::size_t most_elements_beyond_bytes = 1'000'000;

/// Reads what accessors say. All that it gives was in its buffer: every offset, count, stride and
/// index is checked against it. The two that it is made of outlive it.
class AccessorReader {
 public:
  AccessorReader(const Document& document, Buffers& buffers)
      : document_(document), buffers_(buffers) {}

  /// Vectors of a vertex: VEC2 or VEC3 by `width`, `width` numbers an element. Floats keep their
  /// value; integers are numbers, or where they are normalized shares of their largest.
  Result<std::vector<double>> vectors(std::size_t accessor, int width);

  /// SCALAR, unsigned integers.
  Result<std::vector<std::uint32_t>> indices(std::size_t accessor);

  /// Counts the elements of an accessor as read, so that no file makes more of its bytes than they
  /// can hold. Whoever uses again what was read once calls it. Errors: they are too many.
  Result<void> charge(std::size_t accessor);

 private:
  // Elements in a buffer, each `stride` bytes behind the one before.
  struct Elements {
    std::string_view bytes;  // from the first to the end of the last
    std::size_t stride;
  };
  struct Read;  // an accessor that is being read

  Result<std::vector<double>> read(const Read& read);
  Result<Elements> elements(const Read& read, std::size_t view, std::uint64_t offset,
                            std::uint64_t count, std::size_t element_size) const;
  Result<void> put_sparse(const Read& read, std::vector<double>& numbers) const;
  const Document& document_;
  Buffers& buffers_;
  std::uint64_t elements_read_ = 0;
};

}  // namespace pliant::gltf
