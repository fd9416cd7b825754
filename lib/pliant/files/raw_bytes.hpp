#pragma once

#include <span>
#include <string_view>

namespace pliant {

/// The bytes of numbers in memory, which is their representation in the binary formats.
template <class Number>
std::string_view bytes_of(std::span<const Number> numbers) {
  const auto bytes = std::as_bytes(numbers);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace pliant
