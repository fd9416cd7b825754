#include "pliant/states/sealed_bytes.hpp"

#include <bit>
#include <cstring>

namespace pliant {

static_assert(std::endian::native == std::endian::little,
              "numbers are stored as they lie in memory");

void append(std::string& bytes, const void* from, std::size_t size) {
  bytes.append(static_cast<const char*>(from), size);
}

void append(std::string& bytes, std::uint64_t number) { append(bytes, &number, sizeof(number)); }

void append(std::string& bytes, const Hash& hash) {
  append(bytes, hash.high);
  append(bytes, hash.low);
}

void append_seal(std::string& bytes) { append(bytes, hash_of(std::string_view(bytes))); }

std::optional<std::string_view> unsealed(std::string_view bytes, std::string_view magic) {
  if (!bytes.starts_with(magic) || bytes.size() < magic.size() + sizeof(Hash)) return {};
  const std::string_view sealed = bytes.substr(0, bytes.size() - sizeof(Hash));
  if (ByteReader(bytes.substr(sealed.size())).hash() != hash_of(sealed)) return {};
  return sealed.substr(magic.size());
}

std::string_view ByteReader::take(std::uint64_t size) {
  if (size > bytes_.size()) {
    is_sound_ = false;
    return {};
  }
  const std::string_view taken = bytes_.substr(0, static_cast<std::size_t>(size));
  bytes_.remove_prefix(taken.size());
  return taken;
}

void ByteReader::take(void* to, std::size_t size) {
  const std::string_view taken = take(size);
  if (!taken.empty()) std::memcpy(to, taken.data(), taken.size());
}

std::uint64_t ByteReader::number() {
  std::uint64_t number = 0;
  take(&number, sizeof(number));
  return number;
}

Hash ByteReader::hash() {
  const std::uint64_t high = number();
  return {high, number()};
}

}  // namespace pliant
