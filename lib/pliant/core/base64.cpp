#include "pliant/core/base64.hpp"

#include <cstdint>

namespace pliant {
namespace {

constexpr std::uint32_t no_digit = 64;

std::uint32_t digit_of(char c) {
  if (c >= 'A' && c <= 'Z') return static_cast<std::uint32_t>(c - 'A');
  if (c >= 'a' && c <= 'z') return static_cast<std::uint32_t>(c - 'a') + 26;
  if (c >= '0' && c <= '9') return static_cast<std::uint32_t>(c - '0') + 52;
  return c == '+' ? 62 : c == '/' ? 63 : no_digit;
}

}  // namespace

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const std::string_view three = bytes.substr(k, 3);
    std::uint32_t bits = 0;
    for (std::size_t byte = 0; byte < 3; ++byte) {
      bits = bits << 8 | (byte < three.size() ? static_cast<unsigned char>(three[byte]) : 0U);
    }
    for (std::size_t digit = 0; digit < 4; ++digit) {
      text.push_back(digit <= three.size() ? digits[bits >> (18 - 6 * digit) & 63] : '=');
    }
  }
  return text;
}

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

}  // namespace pliant
