#include "pliant/files/gltf/gltf_buffers.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/base64.hpp"
#include "pliant/files/file_object.hpp"

namespace pliant::gltf {
namespace {

constexpr std::string_view data_scheme = "data:";

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
