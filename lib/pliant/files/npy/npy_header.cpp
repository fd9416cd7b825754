#include "pliant/files/npy/npy_header.hpp"

#include <charconv>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pliant/core/byte_order.hpp"
#include "pliant/core/text.hpp"

namespace pliant {
namespace {

tl::unexpected<Error> refuse_head(std::string message) {
  return fail(ErrorCode::InvalidInput, std::move(message));
}

// A part of a head, shortened, as it may be long.
std::string part_of_head(std::string_view text) {
  constexpr std::size_t most = 40;
  return printable(text.size() > most ? fmt::format("{}…", text.substr(0, most))
                                      : std::string(text));
}

// What stands after `'key':`, to the next comma that is in no brackets.
std::optional<std::string_view> value_of_key(std::string_view literal, std::string_view key) {
  for (const char quote : {'\'', '"'}) {
    const std::string name = fmt::format("{0}{1}{0}", quote, key);
    const std::size_t place = literal.find(name);
    if (place == std::string_view::npos) continue;
    std::string_view rest = literal.substr(place + name.size());
    const std::size_t colon = rest.find(':');
    if (colon == std::string_view::npos || !trim(rest.substr(0, colon), " ").empty()) return {};
    rest = rest.substr(colon + 1);
    int depth = 0;
    std::size_t end = 0;
    for (; end < rest.size(); ++end) {
      if (rest[end] == '(') ++depth;
      if (rest[end] == ')') --depth;
      if (depth == 0 && (rest[end] == ',' || rest[end] == '}')) break;
    }
    return trim(rest.substr(0, end), " ");
  }
  return {};
}

// The numbers of `(20, 81, 3)` or `(20,)`.
std::optional<std::vector<std::uint64_t>> counts_of(std::string_view shape) {
  constexpr std::size_t most_counts = 32;
  if (shape.size() < 2 || shape.front() != '(' || shape.back() != ')') return {};
  shape = trim(shape.substr(1, shape.size() - 2), " ");
  if (shape.ends_with(',')) shape.remove_suffix(1);
  std::vector<std::uint64_t> counts;
  while (!shape.empty() && counts.size() < most_counts) {
    const std::size_t comma = std::min(shape.find(','), shape.size());
    const std::string_view text = trim(shape.substr(0, comma), " ");
    std::uint64_t count = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (error != std::errc() || end != text.data() + text.size()) return {};
    counts.push_back(count);
    if (comma == shape.size()) return counts;
    shape = shape.substr(comma + 1);
  }
  return {};
}

// The Python literal {'descr': '<f8', 'fortran_order': False, 'shape': (20, 81, 3), }.
Result<NpyHeader> header_of_literal(std::string_view literal, std::uint64_t begin) {
  const auto kind = value_of_key(literal, "descr");
  const auto order = value_of_key(literal, "fortran_order");
  const auto shape = value_of_key(literal, "shape");
  if (!kind || !order || !shape)
    return refuse_head("its head lacks a descr, a fortran_order or a shape");
  const std::string_view type = trim(*kind, "'\" ");
  if (type != "<f4" && type != "<f8" && type != ">f4" && type != ">f8")
    return refuse_head(
        fmt::format("its numbers are {}, but must be <f8 or <f4: numpy's float64 or float32",
                    part_of_head(type)));
  NpyHeader header{.shape_text = part_of_head(*shape),
                   .is_double = type[2] == '8',
                   .byte_order = type[0] == '>' ? std::endian::big : std::endian::little,
                   .begin = begin};
  if (trim(*order, " ") == "True")
    return refuse_head(
        "its numbers are in Fortran order; numpy.ascontiguousarray gives the order that is read");
  if (trim(*order, " ") != "False")
    return refuse_head("its fortran_order is neither True nor False");
  if (auto counts = counts_of(*shape)) header.shape = *std::move(counts);
  return header;
}

}  // namespace

// Magic, version, length of the header, then a Python literal padded with spaces.
std::string npy_head(std::span<const std::size_t> shape) {
  std::string literal = fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}), }}",
                                    fmt::join(shape, ", "));
  constexpr std::size_t prefix = 10;
  const std::size_t unpadded = prefix + literal.size() + 1;
  literal.append((64 - unpadded % 64) % 64, ' ').push_back('\n');
  std::string header("\x93NUMPY\x01\x00", 8);
  append_number(header, static_cast<std::uint16_t>(literal.size()));
  return header + literal;
}

Result<NpyHeader> read_npy_header(std::string_view bytes, std::uint64_t size) {
  constexpr std::string_view magic = "\x93NUMPY";
  constexpr std::size_t longest = longest_npy_head - 12;
  const auto too_short = [&](std::size_t count) {
    return refuse_head(
        fmt::format("the file has {} bytes, but the head of a .npy has {}", size, count));
  };
  if (bytes.size() < 10) return too_short(10);
  if (bytes.substr(0, magic.size()) != magic)
    return refuse_head("it is no .npy: it does not begin with \\x93NUMPY");
  const int version = static_cast<unsigned char>(bytes[6]);
  if (version < 1 || version > 3)
    return refuse_head(
        fmt::format("its version is {}, but only versions 1 to 3 are read", version));
  const std::size_t begin = version == 1 ? 10 : 12;
  if (bytes.size() < begin) return too_short(begin);
  const std::size_t length = version == 1 ? number_from<std::uint16_t>(bytes.data() + 8)
                                          : number_from<std::uint32_t>(bytes.data() + 8);
  if (length > longest)
    return refuse_head(
        fmt::format("its head has {} bytes, but at most {} are read", length, longest));
  if (bytes.size() < begin + length) return too_short(begin + length);
  return header_of_literal(bytes.substr(begin, length), begin + length);
}

}  // namespace pliant
