#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "pliant/core/field.hpp"

namespace pliant {

/// XXH3 of some bytes, 128 bits. Detects changes, not forgeries.
struct Hash {
  std::uint64_t high = 0;
  std::uint64_t low = 0;

  friend bool operator==(const Hash&, const Hash&) = default;
};

Hash hash_of(std::string_view bytes);

/// Hash of the numbers as little-endian doubles. So -0 and 0 differ.
Hash hash_of(std::span<const double> numbers);

/// The same: x of all rows, then y, then z.
Hash hash_of(const Field& field);

/// 32 hexadecimal digits in lower case, as `xxhsum -H128` prints them.
std::string to_text(const Hash& hash);

/// The hash that `to_text` wrote; nullopt for any other text.
std::optional<Hash> to_hash(std::string_view text);

}  // namespace pliant
