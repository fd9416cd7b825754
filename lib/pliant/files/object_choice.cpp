#include "pliant/files/object_choice.hpp"

#include <algorithm>
#include <charconv>
#include <system_error>

namespace pliant {
namespace {

ObjectMatch named(std::span<const std::string_view> names, std::string_view name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return {static_cast<std::size_t>(std::count(found, names.end(), name)),
          static_cast<std::size_t>(found - names.begin())};
}

// The object of that name with that number among those of it, counted from 1.
ObjectMatch numbered(std::span<const std::string_view> names, std::string_view name,
                     std::size_t number) {
  for (std::size_t k = 0; k < names.size(); ++k)
    if (names[k] == name && --number == 0) return {1, k};
  return {};
}

// The number that a text of digits alone spells; 0: none.
std::size_t to_count(std::string_view digits) {
  std::size_t number = 0;
  const char* const end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, number);
  return error == std::errc() && stop == end ? number : 0;
}

}  // namespace

ObjectMatch find_objects(std::span<const std::string_view> names,
                         std::span<const std::string_view> meshes, std::string_view object) {
  if (object.empty()) return {names.size(), 0};
  for (const auto& each : {names, meshes})
    if (const ObjectMatch match = named(each, object); match.count > 0) return match;
  const std::size_t mark = object.rfind('#');
  if (mark == std::string_view::npos) return {};
  const std::size_t number = to_count(object.substr(mark + 1));
  const std::string_view name = object.substr(0, mark);
  if (number == 0) return {};
  if (name.empty()) return number <= names.size() ? ObjectMatch{1, number - 1} : ObjectMatch{};
  return numbered(named(names, name).count > 0 ? names : meshes, name, number);
}

}  // namespace pliant
