#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"

namespace pliant {

/// What the head of a .npy says of the numbers that follow it. Internal to mesh.
struct NpyHeader {
  std::vector<std::uint64_t> shape = {};  ///< counts, the slowest first
  std::string shape_text = {};            ///< as written, shortened for messages
  bool is_double = false;                 ///< else single precision
  std::endian byte_order = std::endian::little;
  std::uint64_t begin = 0;  ///< of the first number [bytes]

  std::size_t number_size() const { return is_double ? 8 : 4; }
};

/// No head that is read is longer. [bytes]
inline constexpr std::size_t longest_npy_head = 12 + (std::size_t{1} << 16);

/// Reads the head of a file of `size` bytes from its first ones: all of them, or at least
/// `longest_npy_head`. Errors: no .npy of version 1 to 3; its numbers are not float64 or float32;
/// Fortran order; no shape of whole numbers. Whether the numbers are there is not checked.
Result<NpyHeader> read_npy_header(std::string_view bytes, std::uint64_t size);

/// The head of a .npy of float64, little-endian, in C order: format version 1.0 of
/// numpy.lib.format, padded so that the numbers begin at a multiple of 64 bytes. Requires: two
/// counts at least.
std::string npy_head(std::span<const std::size_t> shape);

}  // namespace pliant
