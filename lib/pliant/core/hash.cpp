#include "pliant/core/hash.hpp"

#include <bit>
#include <charconv>

#include <fmt/format.h>
#include <xxhash.h>

namespace pliant {
namespace {

static_assert(std::endian::native == std::endian::little,
              "fields are hashed as they lie in memory");

Hash hash_of(const void* bytes, std::size_t size) {
  const XXH128_hash_t hash = XXH3_128bits(bytes, size);
  return {hash.high64, hash.low64};
}

std::optional<std::uint64_t> to_bits(std::string_view digits) {
  std::uint64_t bits = 0;
  const char* const end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, bits, 16);
  if (error != std::errc() || stop != end) return {};
  return bits;
}

}  // namespace

Hash hash_of(std::string_view bytes) { return hash_of(bytes.data(), bytes.size()); }

Hash hash_of(std::span<const double> numbers) {
  return hash_of(numbers.data(), numbers.size_bytes());
}

Hash hash_of(const Field& field) {
  return hash_of(std::span(field.data(), static_cast<std::size_t>(field.size())));
}

std::string to_text(const Hash& hash) { return fmt::format("{:016x}{:016x}", hash.high, hash.low); }

std::optional<Hash> to_hash(std::string_view text) {
  if (text.size() != 32) return {};
  const auto high = to_bits(text.substr(0, 16));
  const auto low = to_bits(text.substr(16));
  if (!high || !low) return {};
  const Hash hash{*high, *low};
  if (to_text(hash) != text) return {};
  return hash;
}

}  // namespace pliant
