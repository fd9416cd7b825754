#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/core/byte_order.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "viewer/json.hpp"

namespace pliant::viewer {

/// The arrays after the head. The head gives the offset and length of each.
class Arrays {
 public:
  /// Little-endian numbers of four bytes, or bytes. Each array begins at an offset that is a
  /// multiple of four.
  template <class Number>
  Json add(std::span<const Number> numbers) {
    const std::size_t begin = bytes_.size();
    bytes_.resize(begin + numbers.size_bytes());
    if (!numbers.empty()) std::memcpy(bytes_.data() + begin, numbers.data(), numbers.size_bytes());
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    return {{"begin", begin}, {"count", numbers.size()}};
  }
  template <class Number>
  Json add(const std::vector<Number>& numbers) {
    return add(std::span<const Number>(numbers));
  }
  Json add(const std::string& bytes) { return add(std::span<const char>(bytes)); }

  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// What a page unpacks: the length of the head, the head and the arrays.
inline std::string joined(const Json& head, const std::string& arrays) {
  // An author's text may contain bytes that are not UTF-8.
  std::string text = head.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string bytes;
  append_number(bytes, static_cast<std::uint32_t>(text.size()));
  return bytes + text + arrays;
}

/// A raw deflate stream (RFC 1951) of the bytes. Errors: OutOfMemory; Interrupted.
Result<std::string> deflated(std::string_view bytes, const StopRequest& should_stop = {});

}  // namespace pliant::viewer
