#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "pliant/core/hash.hpp"

namespace pliant {

// Bytes that begin with a magic number and end with a seal, the hash of all bytes before it;
// numbers have 8 bytes, little-endian. Not for programs.

void append(std::string& bytes, const void* from, std::size_t size);
void append(std::string& bytes, std::uint64_t number);
void append(std::string& bytes, const Hash& hash);

/// Appends the seal; nothing may follow.
void append_seal(std::string& bytes);

/// The bytes between the magic number and the seal; null if the magic number differs or any byte
/// has changed since sealing.
std::optional<std::string_view> unsealed(std::string_view bytes, std::string_view magic);

/// Reads bytes from the front. Requires: the bytes outlive it. Reading past the end returns zeros
/// or no bytes, and makes `is_sound` false.
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
