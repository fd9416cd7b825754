#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "pliant/core/hash.hpp"

namespace pliant {

// Bytes that begin with a magic and end with a seal, the hash of all that is ahead of it; numbers
// in them take 8 bytes, little endian. Not for other rooms.

void append(std::string& bytes, const void* from, std::size_t size);
void append(std::string& bytes, std::uint64_t number);
void append(std::string& bytes, const Hash& hash);

/// The end of what is appended.
void append_seal(std::string& bytes);

/// What stands between the magic and the seal; nothing where the bytes begin otherwise, or where
/// one of them is not as it was sealed.
std::optional<std::string_view> unsealed(std::string_view bytes, std::string_view magic);

/// Takes bytes from the front, which outlive it. What is not there is taken as zeros, or none, and
/// told by `is_sound`.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  bool is_sound() const { return is_sound_; }
  std::size_t left() const { return bytes_.size(); }

  std::string_view take(std::uint64_t size);
  void take(void* to, std::size_t size);
  std::uint64_t number();
  Hash hash();

 private:
  std::string_view bytes_;
  bool is_sound_ = true;
};

}  // namespace pliant
