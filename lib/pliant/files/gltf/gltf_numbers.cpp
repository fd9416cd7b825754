#include "pliant/files/gltf/gltf_numbers.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "pliant/core/byte_order.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/open_file.hpp"
#include "pliant/files/read_file.hpp"

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t digit_count = 16;
constexpr std::string_view ending = ".bin";
constexpr std::size_t longest_text = std::size_t{256} << 20;  // [bytes]

std::string_view digits_in(std::string_view name) {
  return name.substr(name.size() - ending.size() - digit_count, digit_count);
}

// Calls `use` with the path of each regular file in the folder; false: not all were found.
template <class Use>
bool each_neighbour(const fs::path& gltf, const Use& use) {
  std::error_code error;
  const fs::path folder = gltf.has_parent_path() ? gltf.parent_path() : fs::path(".");
  for (fs::directory_iterator place(folder, error), end; !error && place != end;
       place.increment(error)) {
    std::error_code unknown;
    if (place->is_regular_file(unknown)) use(place->path());
  }
  return !error;
}

// The character of the hexadecimal digits of an escape, if it is an ASCII one; 0: it is none.
char escaped(std::string_view digits) {
  unsigned code = 0;
  const char* const end = digits.data() + digits.size();
  return std::from_chars(digits.data(), end, code, 16).ptr == end && code < 0x80
             ? static_cast<char>(code)
             : '\0';
}

// A text without the escapes of JSON and of URIs: digits in it are plain. It is not parsed: a
// neighbour may be large, and when in doubt its numbers stay.
std::string plain(std::string_view text) {
  const auto without = [](std::string_view from, std::string_view mark, std::size_t digits) {
    std::string to;
    to.reserve(from.size());
    for (std::size_t k = 0; k < from.size(); ++k) {
      const std::size_t begin = k + mark.size();
      const bool is_escape = from.substr(k).starts_with(mark) && from.size() - begin >= digits;
      const char c = is_escape ? escaped(from.substr(begin, digits)) : '\0';
      to += c != '\0' ? c : from[k];
      if (c != '\0') k = begin + digits - 1;
    }
    return to;
  };
  const std::string unescaped = without(without(text, "\\u", 4), "%", 2);
  // Readers of URIs pass over tabs and line ends, as they are and as escapes of JSON.
  std::string result;
  result.reserve(unescaped.size());
  for (std::size_t k = 0; k < unescaped.size(); ++k) {
    const char c = unescaped[k], next = k + 1 < unescaped.size() ? unescaped[k + 1] : '\0';
    if (c == '\\' && (next == 't' || next == 'n' || next == 'r')) {
      ++k;
    } else if (c != '\t' && c != '\n' && c != '\r') {
      result += c;
    }
  }
  return result;
}

// The JSON of a .gltf or a .glb; null: it cannot be read, or is too large.
std::optional<std::string> json_of(const fs::path& file) {
  constexpr std::size_t head = 20;  // of a .glb, up to its JSON; the length of that is at 12
  std::string text;
  std::size_t end = longest_text;
  const auto read = read_pieces(file, [&](std::string_view piece) {
    const bool is_first = text.empty();
    text += piece;
    if (is_first && text.size() >= head && text.starts_with("glTF")) {
      end = head + number_from<std::uint32_t>(text.data() + 12);
    }
    return text.size() <= end;
  });
  const bool is_glb = end != longest_text;
  if (!read || end > longest_text || (!is_glb && text.size() > end)) return {};
  text.resize(std::min(end, text.size()));
  // Another kind of chunk comes first, or it is no UTF-8.
  if (is_glb && text.substr(16, 4) != "JSON") return {};
  if (text.find('\0', is_glb ? head : 0) != std::string::npos) return {};
  return text;
}

// Drops the files that another one refers to. False: it cannot be known.
bool erase_named(const fs::path& other, std::vector<fs::path>& files) {
  const auto text = json_of(other);
  if (!text) return false;
  const std::string words = plain(*text);
  std::erase_if(files, [&](const fs::path& file) {
    return words.find(digits_in(file.filename().string())) != std::string::npos;
  });
  return true;
}

}  // namespace

fs::path numbers_file(const fs::path& gltf, const Hash& hash) {
  const std::string digits = to_text(hash).substr(0, digit_count);
  return gltf.parent_path() / (gltf.stem().string() + '.' + digits + std::string(ending));
}

bool is_numbers_file(const fs::path& gltf, std::string_view name) {
  const std::string head = gltf.stem().string() + '.';
  if (name.size() != head.size() + digit_count + ending.size() || !name.starts_with(head) ||
      !name.ends_with(ending)) {
    return false;
  }
  const std::string_view digits = digits_in(name);
  return std::all_of(digits.begin(), digits.end(),
                     [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

namespace {

// Whether a file has the hash in its name: files of other programs are never removed.
bool is_of_its_name(const fs::path& gltf, const fs::path& file) {
  const auto opened = OpenFile::open(file);
  const auto hash = opened ? hash_of_file(*opened) : fail(opened.error());
  return hash && numbers_file(gltf, *hash).filename() == file.filename();
}

}  // namespace

std::vector<fs::path> numbers_named_by(const fs::path& gltf) {
  std::vector<fs::path> files;
  each_neighbour(gltf, [&](const fs::path& file) {
    if (is_numbers_file(gltf, file.filename().string())) files.push_back(file);
  });
  if (files.empty()) return files;
  std::vector<fs::path> others = files;
  if (!erase_named(gltf, others)) return {};
  std::erase_if(files, [&](const fs::path& file) {
    return std::find(others.begin(), others.end(), file) != others.end();
  });
  return files;
}

void remove_unnamed_numbers(const fs::path& gltf, std::vector<fs::path> files) {
  if (files.empty()) return;
  erase_named(gltf, files);  // usually all of them
  std::vector<fs::path> others;
  const bool is_complete = each_neighbour(gltf, [&](const fs::path& file) {
    const std::string ending = ending_of(file);
    if (ending == ".gltf" || ending == ".glb") others.push_back(file);
  });
  if (!is_complete) return;
  for (const fs::path& other : others)
    if (files.empty() || !erase_named(other, files)) return;  // it may refer to any of them
  std::error_code ignored;
  for (const fs::path& file : files)
    if (is_of_its_name(gltf, file)) fs::remove(file, ignored);
}

}  // namespace pliant
