#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pliant::viewer {

struct HttpField {
  std::string name;  ///< in lower case
  std::string value;
};

/// A request without its body.
struct HttpHead {
  std::string method;
  std::string target;
  std::vector<HttpField> fields;  ///< no name twice
  std::uint64_t body_size = 0;    ///< [bytes]

  /// The value of a field, or null. `name` in lower case.
  const std::string* find(std::string_view name) const;
};

/// Finds the end of a request's head, byte by byte, and rejects early anything that two parsers
/// might read differently: bytes other than printable ASCII, a line end other than CR LF, a line
/// continued on the next one (obs-fold), a first line not of HTTP/1.1. An accepted head must still
/// be parsed.
class HeadScanner {
 public:
  enum class State { More, Complete, Malformed, TooLarge };

  HeadScanner(std::size_t most_bytes, std::size_t most_lines)
      : most_bytes_(most_bytes), most_lines_(most_lines) {}

  /// Adds the next byte. After a state other than `More` the head has ended.
  State take(char byte);

  const std::string& text() const { return text_; }  ///< all bytes so far
  bool is_empty() const { return text_.empty(); }

 private:
  State end_line();

  std::size_t most_bytes_;
  std::size_t most_lines_;
  std::string text_;
  std::size_t line_begin_ = 0;
  std::size_t lines_ = 0;
};

}  // namespace pliant::viewer
