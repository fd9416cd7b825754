#include "pliant/mesh/gltf_buffers.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

namespace pliant::gltf {
namespace {

constexpr std::string_view data_scheme = "data:";
constexpr std::size_t max_bytes = std::size_t{4} << 30;

constexpr std::uint32_t no_digit = 64;

std::uint32_t digit_of(char c) {
  if (c >= 'A' && c <= 'Z') return static_cast<std::uint32_t>(c - 'A');
  if (c >= 'a' && c <= 'z') return static_cast<std::uint32_t>(c - 'a') + 26;
  if (c >= '0' && c <= '9') return static_cast<std::uint32_t>(c - '0') + 52;
  return c == '+' ? 62 : c == '/' ? 63 : no_digit;
}

// RFC 4648, padded; nullopt: the text is not base64.
std::optional<std::string> from_base64(std::string_view text) {
  if (text.size() % 4 != 0) return std::nullopt;
  const std::size_t padding = text.ends_with("==") ? 2 : text.ends_with('=') ? 1 : 0;
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  for (std::size_t at = 0; at < text.size(); at += 4) {
    const std::size_t digits = at + 4 == text.size() ? 4 - padding : 4;
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t digit = k < digits ? digit_of(text[at + k]) : 0;
      if (digit == no_digit) return std::nullopt;
      bits = bits << 6 | digit;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const auto byte = static_cast<char>(bits >> (16 - 8 * k) & 0xff);
      if (k + 1 < digits)
        bytes += byte;
      else if (byte != 0)
        return std::nullopt;
    }
  }
  return bytes;
}

// data:[KIND];base64,DIGITS
Result<std::string> bytes_of_data(std::string_view uri, std::size_t buffer) {
  constexpr std::string_view marker = ";base64";
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos || !uri.substr(0, comma).ends_with(marker))
    return invalid(fmt::format("buffers[{}].uri is data that is not marked as base64", buffer));
  auto bytes = from_base64(uri.substr(comma + 1));
  if (!bytes) return invalid(fmt::format("buffers[{}].uri is not valid base64", buffer));
  return *std::move(bytes);
}

}  // namespace

bool is_data(std::string_view uri) { return uri.starts_with(data_scheme); }

Buffers::Buffers(const Document& document, std::optional<std::string_view> binary,
                 std::size_t file_size, const ReadReference& read_file)
    : document_(document),
      binary_(binary),
      size_so_far_(file_size),
      read_file_(read_file),
      owned_(document.buffers.size()) {}

Result<std::string_view> Buffers::bytes(std::size_t buffer) {
  const Buffer& entry = document_.buffers[buffer];
  std::string_view bytes;
  if (entry.uri) {
    std::optional<std::string>& owned = owned_[buffer];
    if (!owned) {
      auto read_bytes = read(buffer);
      if (!read_bytes) return fail(read_bytes.error());
      owned = *std::move(read_bytes);
      if (!is_data(*entry.uri)) size_so_far_ += owned->size();
    }
    bytes = *owned;
  } else if (buffer == 0 && binary_) {
    bytes = *binary_;
  } else {
    return invalid(fmt::format("buffers[{}] has no uri, and no bytes in the file", buffer));
  }
  if (entry.size <= bytes.size()) return bytes.substr(0, static_cast<std::size_t>(entry.size));
  return invalid(fmt::format("buffers[{}] is truncated: it has {} of {} bytes", buffer,
                             bytes.size(), entry.size));
}

Result<std::string> Buffers::read(std::size_t buffer) const {
  const std::string& uri = *document_.buffers[buffer].uri;
  if (is_data(uri)) return bytes_of_data(uri, buffer);
  if (!read_file_) return invalid(fmt::format("buffers[{}] is in another file", buffer));
  return read_file_(uri, max_bytes - std::min(max_bytes, size_so_far_));
}

}  // namespace pliant::gltf
