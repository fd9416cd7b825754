#include "pliant/files/gltf/gltf_buffers.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "pliant/files/file_object.hpp"

namespace pliant::gltf {
namespace {

constexpr std::string_view data_scheme = "data:";
constexpr std::uint32_t no_digit = 64;

std::uint32_t digit_of(char c) {
  if (c >= 'A' && c <= 'Z') return static_cast<std::uint32_t>(c - 'A');
  if (c >= 'a' && c <= 'z') return static_cast<std::uint32_t>(c - 'a') + 26;
  if (c >= '0' && c <= '9') return static_cast<std::uint32_t>(c - '0') + 52;
  return c == '+' ? 62 : c == '/' ? 63 : no_digit;
}

// RFC 4648, padded; nullopt: the text is not base64, or the work has to end.
std::optional<std::string> from_base64(std::string_view text, StopPoll& poll) {
  if (text.size() % 4 != 0) return std::nullopt;
  const std::size_t padding = text.ends_with("==") ? 2 : text.ends_with('=') ? 1 : 0;
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  for (std::size_t at = 0; at < text.size(); at += 4) {
    const std::size_t digits = at + 4 == text.size() ? 4 - padding : 4;
    if (poll.after(4)) return std::nullopt;
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
Result<std::string> bytes_of_data(std::string_view uri, std::size_t buffer,
                                  const StopRequest& should_stop) {
  constexpr std::string_view marker = ";base64";
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos || !uri.substr(0, comma).ends_with(marker))
    return invalid(fmt::format("buffers[{}].uri is data that is not marked as base64", buffer));
  StopPoll poll(should_stop);
  auto bytes = from_base64(uri.substr(comma + 1), poll);
  if (poll.after(0)) return interrupted();
  if (!bytes) return invalid(fmt::format("buffers[{}].uri is not valid base64", buffer));
  return *std::move(bytes);
}

}  // namespace

bool is_data(std::string_view uri) { return uri.starts_with(data_scheme); }

Buffers::Buffers(const Document& document, std::optional<std::string_view> binary,
                 std::size_t file_size, const ReadReference& read_file, IdentifyReference identify,
                 StopRequest should_stop)
    : document_(document),
      binary_(binary),
      size_so_far_(file_size),
      read_file_(read_file),
      identify_(std::move(identify)),
      should_stop_(std::move(should_stop)),
      read_(document.buffers.size()) {}

Result<std::string_view> Buffers::bytes(std::size_t buffer) {
  const Buffer& entry = document_.buffers[buffer];
  std::optional<std::string_view>& bytes = read_[buffer];
  if (!bytes && entry.uri) {
    const auto found = read(buffer);
    if (!found) return fail(found.error());
    bytes = *found;
  } else if (!bytes && buffer == 0 && binary_) {
    bytes = binary_;
  } else if (!bytes) {
    return invalid(fmt::format("buffers[{}] has no uri, and no bytes in the file", buffer));
  }
  if (entry.size <= bytes->size()) return bytes->substr(0, static_cast<std::size_t>(entry.size));
  return invalid(fmt::format("buffers[{}] is truncated: it has {} of {} bytes", buffer,
                             bytes->size(), entry.size));
}

Result<std::string_view> Buffers::read(std::size_t buffer) {
  const std::string& uri = *document_.buffers[buffer].uri;
  if (is_data(uri)) {
    auto bytes = bytes_of_data(uri, buffer, should_stop_);
    if (!bytes) return fail(bytes.error());
    return data_.emplace_back(*std::move(bytes));
  }
  if (!read_file_) return invalid(fmt::format("buffers[{}] is in another file", buffer));
  const std::string name = identify_ ? identify_(uri) : uri;
  if (const auto known = files_.find(name); known != files_.end()) return known->second;
  auto bytes = read_file_(uri, largest_mesh_file - std::min(largest_mesh_file, size_so_far_));
  if (!bytes) return fail(bytes.error());
  size_so_far_ += bytes->size();
  return files_.emplace(name, *std::move(bytes)).first->second;
}

}  // namespace pliant::gltf
