#include "pliant/mesh/assimp_guard_fbx.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "pliant/mesh/nesting.hpp"

namespace pliant {
namespace {

tl::unexpected<Error> broken(std::string message) {
  return fail(ErrorCode::InvalidInput, std::move(message));
}

// A string, or a whole number; of other kinds neither is known.
struct Value {
  std::string_view text = {};
  std::uint64_t number = 0;
};

constexpr std::size_t most_values = 4;  // more are never looked at

struct Node {
  std::string_view name = {};
  std::vector<Value> values = {};  // the first of them
};

// `Layer` and `LayerElementUV` carry a number; the plain `LayerElement` within a layer does not.
bool needs_number(std::string_view name) {
  return name.starts_with("Layer") && name != "LayerElement";
}

// What the nodes say, whichever node they are in.
class NodeCheck {
 public:
  Result<void> add(const Node& node) {
    const auto& values = node.values;
    if (values.empty() && needs_number(node.name))
      return broken(fmt::format("{} has no number", node.name.substr(0, 40)));
    if (node.name == "Model" && !values.empty() && values[0].number != 0)
      models_.insert(values[0].number);
    // An "OP" links to a property: no child, unless it leaves out which one.
    if (node.name == "C" && values.size() >= 3 && values[0].text != "PP" &&
        (values[0].text != "OP" || values.size() < 4 || values[3].text.empty()))
      children_.emplace(values[2].number, values[1].number);
    return {};
  }

  // Walks the models as assimp does, from 0 at the root, which puts a copy below each parent.
  // Links that are no child of a model (the bones of a skin) may well go round in circles.
  Result<void> check_models() const {
    struct Visit {
      std::uint64_t model;
      std::size_t depth;
    };
    std::vector<Visit> visits = {{0, 0}};
    std::size_t count = 0;
    while (!visits.empty()) {
      const Visit visit = visits.back();
      visits.pop_back();
      if (visit.depth > deepest_nesting) return too_deep();
      const auto [first, last] = children_.equal_range(visit.model);
      for (auto child = first; child != last; ++child) {
        if (!models_.contains(child->second)) continue;
        if (++count > models_.size() + most_copies) {
          return broken(
              fmt::format("the file's links make more than {} copies of its models", most_copies));
        }
        visits.push_back({child->second, visit.depth + 1});
      }
    }
    return {};
  }

 private:
  static constexpr std::size_t most_copies = 10'000;

  std::set<std::uint64_t> models_;
  std::multimap<std::uint64_t, std::uint64_t> children_;  // by parent; both may be no models
};

// --- Text ---

// The digits that a word starts with. A number too large runs over, as in assimp.
std::uint64_t leading_number(std::string_view word) {
  std::uint64_t number = 0;
  for (const char c : word) {
    if (c < '0' || c > '9') break;
    number = 10 * number + static_cast<std::uint64_t>(c - '0');
  }
  return number;
}

// A name, a colon, values, and then maybe nodes in braces. What does not fit, assimp finds.
Result<void> check_text(std::string_view text) {
  text = text.substr(0, text.find('\0'));
  const auto find = [&](std::string_view any, std::size_t from) {
    return std::min(text.find_first_of(any, from), text.size());
  };
  NodeCheck check;
  Node node;
  std::size_t depth = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t start = at++;
    const char c = text[start];
    if (std::string_view(" \t\r\n\f,:").find(c) != std::string_view::npos) continue;
    if (c == ';') {
      at = find("\r\n\f", at);
    } else if (c == '{' || c == '}') {
      if (auto checked = check.add(node); !checked) return checked;
      node = {};
      if (c == '{' && ++depth > deepest_nesting) return too_deep();
      if (c == '}' && depth > 0) --depth;
    } else if (c == '"') {
      const std::size_t end = find("\"", at);
      if (node.values.size() < most_values)
        node.values.push_back({.text = text.substr(at, end - at)});
      at = end + 1;
    } else {
      at = find(" \t\r\n\f,:;{}\"", at);
      const std::string_view word = text.substr(start, at - start);
      if (at < text.size() && text[at] == ':') {
        if (auto checked = check.add(node); !checked) return checked;
        node = {.name = word};
      } else if (node.values.size() < most_values) {
        node.values.push_back({.number = leading_number(word)});
      }
    }
  }
  return check.check_models();
}

// --- Binary ---

std::uint64_t number_at(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint64_t number = 0;
  for (std::size_t k = 0; k < size; ++k)
    number |= std::uint64_t{static_cast<unsigned char>(bytes[at + k])} << 8 * k;
  return number;
}

// A letter for the kind of each: S is a string after its length, L a number of 8 bytes.
std::vector<Value> first_values(std::string_view bytes) {
  std::vector<Value> values;
  while (!bytes.empty() && values.size() < most_values) {
    std::size_t size = 0;
    if (bytes[0] == 'S' && bytes.size() >= 5) {
      size = 5 + number_at(bytes, 1, 4);
      values.push_back({.text = bytes.substr(5, size - 5)});
    } else if (bytes[0] == 'L' && bytes.size() >= 9) {
      size = 9;
      values.push_back({.number = number_at(bytes, 1, 8)});
    } else {  // no link and no model goes on like that
      values.push_back({});
      return values;
    }
    bytes.remove_prefix(std::min(size, bytes.size()));
  }
  return values;
}

// A node says where it ends, count and size of its values, in 4 bytes each (8 from version 7.5 on),
// and the length of its name, in 1; then come name, values, and maybe nodes and a head of zeros.
// An end of zero alone is passed over within a node, and ends the file elsewhere. What does not
// fit, assimp finds before it does anything else.
Result<void> check_binary(std::string_view bytes) {
  constexpr std::size_t header = 27, version_at = 23;
  if (bytes.size() < header) return {};
  const std::size_t width = number_at(bytes, version_at, 4) >= 7500 ? 8 : 4;
  const std::size_t head = 3 * width + 1;
  NodeCheck check;
  std::vector<std::size_t> ends;  // of the nodes that we are within, their zeros left off
  for (std::size_t at = header;;) {
    while (!ends.empty() && at >= ends.back()) {
      at = ends.back() + head;
      ends.pop_back();
    }
    const std::size_t room = (ends.empty() ? bytes.size() : ends.back()) - at;
    if (room == 0) break;
    if (room < width) return {};
    const std::uint64_t end = number_at(bytes, at, width);
    if (end == 0 && ends.empty()) break;
    if (end == 0) {
      at += width;
      continue;
    }
    if (room < head || end > at + room) return {};
    const std::uint64_t value_size = number_at(bytes, at + 2 * width, width);
    const std::size_t name_size = static_cast<unsigned char>(bytes[at + head - 1]);
    if (name_size > room - head || value_size > room - head - name_size) return {};
    const std::size_t values_at = at + head + name_size;
    const Node node = {.name = bytes.substr(at + head, name_size),
                       .values = first_values(bytes.substr(values_at, value_size))};
    if (auto checked = check.add(node); !checked) return checked;
    at = values_at + value_size;
    if (end < at || (end > at && end - at < head)) return {};
    if (end > at) ends.push_back(end - head);
    if (ends.size() > deepest_nesting) return too_deep();
  }
  return check.check_models();
}

}  // namespace

Result<void> check_fbx(std::string_view bytes) {
  return bytes.starts_with("Kaydara FBX Binary") ? check_binary(bytes) : check_text(bytes);
}

}  // namespace pliant
