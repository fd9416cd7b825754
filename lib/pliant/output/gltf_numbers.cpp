#include "pliant/output/gltf_numbers.hpp"

#include <algorithm>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

#include "pliant/core/hash_stream.hpp"
#include "pliant/core/read_file.hpp"
#include "pliant/core/text.hpp"

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t digit_count = 16;
constexpr std::string_view ending = ".bin";
constexpr std::size_t longest_text = std::size_t{256} << 20;  // [bytes]

std::string_view digits_in(std::string_view name) {
  return name.substr(name.size() - ending.size() - digit_count, digit_count);
}

struct Neighbours {
  std::vector<fs::path> numbers;  // of the given .gltf
  std::vector<fs::path> gltfs;    // all of them
  bool is_complete = false;
};

Neighbours neighbours_of(const fs::path& gltf) {
  Neighbours found;
  std::error_code error;
  const fs::path folder = gltf.has_parent_path() ? gltf.parent_path() : fs::path(".");
  for (fs::directory_iterator place(folder, error), end; !error && place != end;
       place.increment(error)) {
    std::error_code unknown;
    if (!place->is_regular_file(unknown)) continue;
    if (is_numbers_file(gltf, place->path().filename().string()))
      found.numbers.push_back(place->path());
    if (ending_of(place->path()) != ".gltf") continue;
    // The .gltf that most probably refers to them is first.
    const bool is_first = place->path().filename() == gltf.filename();
    found.gltfs.insert(is_first ? found.gltfs.begin() : found.gltfs.end(), place->path());
  }
  found.is_complete = !error;
  return found;
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
  std::ifstream in(file, std::ios::binary);
  HashStream hash;
  std::vector<char> piece(std::size_t{1} << 20);
  while (in) {
    in.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    hash.add({piece.data(), static_cast<std::size_t>(in.gcount())});
  }
  return in.eof() && numbers_file(gltf, hash.hash()).filename() == file.filename();
}

}  // namespace

void remove_unnamed_numbers(const fs::path& gltf) {
  Neighbours found = neighbours_of(gltf);
  // Usually there is one, and it is in use.
  if (!found.is_complete || found.numbers.empty()) return;
  for (const fs::path& other : found.gltfs) {
    const auto text = read_file(other, longest_text);
    if (!text) return;  // it may refer to any of them
    // Only the digits: they are the same however the rest of the name is escaped.
    std::erase_if(found.numbers, [&](const fs::path& file) {
      return text->find(digits_in(file.filename().string())) != std::string::npos;
    });
    if (found.numbers.empty()) return;
  }
  std::error_code ignored;
  for (const fs::path& file : found.numbers)
    if (is_of_its_name(gltf, file)) fs::remove(file, ignored);
}

}  // namespace pliant
