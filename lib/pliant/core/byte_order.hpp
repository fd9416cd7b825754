#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>

namespace pliant {

/// The number that lies in memory or a file. Requires: as many bytes as it has.
template <class Number>
Number number_from(const char* bytes, std::endian order = std::endian::little) {
  std::array<char, sizeof(Number)> own;
  std::copy_n(bytes, own.size(), own.begin());
  if (order != std::endian::native) std::reverse(own.begin(), own.end());
  return std::bit_cast<Number>(own);
}

/// The same of up to eight bytes without a sign.
inline std::uint64_t bits_from(const char* bytes, std::size_t size,
                               std::endian order = std::endian::little) {
  std::array<char, sizeof(std::uint64_t)> padded{};
  std::copy_n(bytes, size, order == std::endian::little ? padded.begin() : padded.end() - size);
  return number_from<std::uint64_t>(padded.data(), order);
}

/// Appends its bytes.
template <class Number>
void append_number(std::string& bytes, Number number, std::endian order = std::endian::little) {
  auto own = std::bit_cast<std::array<char, sizeof(Number)>>(number);
  if (order != std::endian::native) std::reverse(own.begin(), own.end());
  bytes.append(own.data(), own.size());
}

}  // namespace pliant
