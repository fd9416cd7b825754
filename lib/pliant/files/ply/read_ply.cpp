#include "pliant/files/ply/read_ply.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/core/byte_order.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/file_object.hpp"
#include "pliant/files/ply/ply_header.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/mesh/normals.hpp"
#include "pliant/mesh/triangles/equal_numbers.hpp"

namespace pliant {
namespace {

using namespace ply;

// The numbers of the elements, one after the other.
class Numbers {
 public:
  Numbers(std::string_view bytes, Encoding encoding, int line, StopPoll& poll)
      : bytes_(bytes), encoding_(encoding), line_(line), poll_(poll) {}

  // nullopt: the file ends here, or there is no finite number; or the work has to end.
  std::optional<double> next(NumberType type) {
    return encoding_ == Encoding::Ascii ? next_word() : next_bytes(type);
  }

  // Upper bound of the remaining numbers of this type.
  std::int64_t room(NumberType type) const {
    const std::size_t left = bytes_.size() - at_;
    return static_cast<std::int64_t>(encoding_ == Encoding::Ascii ? (left + 1) / 2
                                                                  : left / size_of(type));
  }

  // Whether the last number was missing because the file ends there.
  bool has_run_out() const { return has_run_out_; }

  // 0 if only blanks are left.
  std::size_t bytes_left() {
    std::size_t end = bytes_.size();
    while (end > at_ && is_blank(end - 1) && !poll_.after()) --end;
    while (at_ < end && is_blank(at_) && !poll_.after()) ++at_;
    return end - at_;
  }

  int line() const { return encoding_ == Encoding::Ascii ? line_ : 0; }

 private:
  bool is_blank(std::size_t place) const {
    return ascii_blanks.find(bytes_[place]) != std::string_view::npos;
  }

  std::optional<double> next_word() {
    while (at_ < bytes_.size() && is_blank(at_) && !poll_.after()) line_ += bytes_[at_++] == '\n';
    const std::size_t begin = at_;
    while (at_ < bytes_.size() && !is_blank(at_) && !poll_.after()) ++at_;
    const std::string_view word = bytes_.substr(begin, at_ - begin);
    has_run_out_ = word.empty();
    return to_number(word);
  }

  std::optional<double> next_bytes(NumberType type) {
    const std::size_t size = size_of(type);
    has_run_out_ = bytes_.size() - at_ < size;
    if (has_run_out_) return std::nullopt;
    const bool is_little = encoding_ == Encoding::LittleEndian;
    const std::uint64_t bits =
        bits_from(bytes_.data() + at_, size, is_little ? std::endian::little : std::endian::big);
    at_ += size;
    const double number = to_double(bits, type);
    return std::isfinite(number) ? std::optional(number) : std::nullopt;
  }

  static double to_double(std::uint64_t bits, NumberType type) {
    switch (type) {
      case NumberType::Int8:
        return static_cast<std::int8_t>(bits);
      case NumberType::Int16:
        return static_cast<std::int16_t>(bits);
      case NumberType::Int32:
        return static_cast<std::int32_t>(bits);
      case NumberType::Float32:
        return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
      case NumberType::Float64:
        return std::bit_cast<double>(bits);
      default:
        return static_cast<double>(bits);
    }
  }

  std::string_view bytes_;
  Encoding encoding_;
  int line_;
  StopPoll& poll_;
  std::size_t at_ = 0;
  bool has_run_out_ = false;
};

class PlyReader {
 public:
  PlyReader(const Header& header, std::string_view body, std::span<const std::string> attributes,
            const StopRequest& should_stop)
      : header_(header),
        names_(attributes),
        should_stop_(should_stop),
        poll_(should_stop),
        numbers_(body, header.encoding, header.line_count + 1, poll_) {}

  Result<Mesh> read() {
    has_numbered_uvs_ =
        has(uv_element, "u", false) && has(uv_element, "v", false) && has("face", uv_indices, true);
    has_numbered_normals_ = has("face", normal_indices, true);
    for (const PlyElement& element : header_.elements) {
      if (auto read = read_element(element); !read) return fail(read.error());
    }
    left_out_.add("byte after its last element", "bytes after its last element",
                  static_cast<std::int64_t>(numbers_.bytes_left()));
    if (poll_.after(0)) return interrupted();
    if (!mesh_.corner_vertices.empty()) {
      if (auto checked = check_indices(); !checked) return fail(checked.error());
    }
    mesh_.positions = to_positions(coordinates_);
    if (mesh_.face_sizes.empty()) return invalid("the file has no faces");
    left_out_.add("(u,v) that is not a pair of numbers", "(u,v) that are not pairs of numbers",
                  drop_invalid_uvs(mesh_));
    mesh_.left_out = left_out_.text();
    if (has_numbered_normals_) {
      mesh_.corner_normals = numbers_of_equal(normal_numbers_, poll_);
      if (poll_.after(0)) return interrupted();
    } else if (!normals_.empty()) {
      auto shared =
          shared_normals(mesh_, {std::move(normals_), mesh_.corner_vertices, {}}, should_stop_);
      if (!shared) return fail(shared.error());
      mesh_.corner_normals = *std::move(shared);
    }
    return std::move(mesh_);
  }

 private:
  static constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
  static constexpr std::size_t parts_of_number = 16;

  // One property: a number, or the numbers of its list; `not_a_number` for what is no finite
  // number.
  using Values = std::vector<std::vector<double>>;

  // Whether an element of the file has a property, a list or a number.
  bool has(std::string_view name, std::string_view property, bool is_list) const {
    const auto element = std::ranges::find(header_.elements, name, &PlyElement::name);
    if (element == header_.elements.end()) return false;
    const int place = element->find({property});
    return place >= 0 && is_list_of(*element, place) == is_list;
  }

  static bool is_list_of(const PlyElement& element, int property) {
    return element.properties[static_cast<std::size_t>(property)].count_type.has_value();
  }

  Result<void> read_element(const PlyElement& element) {
    const bool is_vertex = element.name == "vertex";
    const bool is_face = element.name == "face";
    const bool is_strip = element.name == "tristrips";
    const bool is_uv = has_numbered_uvs_ && element.name == uv_element;
    if (element.properties.empty() && element.count > 0)
      return invalid(fmt::format("the element {} has no properties", in_quotes(element.name)));
    if (is_vertex) {
      if (auto found = find_vertex_properties(element); !found) return found;
    }
    if (is_face || is_strip) {
      if (auto found = find_face_properties(element); !found) return found;
    }
    if (element.name == "edge") left_out_.add("edge", "edges", element.count);
    needed_ = {};
    if (is_vertex) {
      needed_ = {x_, y_, z_};
      needed_.insert(needed_.end(), attributes_.begin(), attributes_.end());
    }
    if (is_face || is_strip) needed_ = {corners_};
    Values values(element.properties.size());
    for (std::int64_t k = 0; k < element.count; ++k) {
      if (auto read = read_values(element, k, values); !read) return read;
      if (is_vertex) add_vertex(values);
      if (is_uv) {
        const auto number = [&](std::string_view name) {
          return values[static_cast<std::size_t>(element.find({name}))][0];
        };
        numbered_uvs_.push_back({number("u"), number("v")});
      }
      if (is_face || is_strip) {
        if (auto added = is_face ? add_face(values, k) : add_strip(values, k); !added) return added;
      }
    }
    return {};
  }

  Result<void> find_vertex_properties(const PlyElement& vertex) {
    x_ = vertex.find({"x"});
    y_ = vertex.find({"y"});
    z_ = vertex.find({"z"});
    for (const auto& [u, v] : uv_names) {
      if (u_ >= 0 || vertex.find({u}) < 0 || vertex.find({v}) < 0) continue;
      u_ = vertex.find({u});
      v_ = vertex.find({v});
    }
    if (x_ < 0 || y_ < 0 || z_ < 0) return invalid("the vertices have no x, y and z");
    const auto is_list = [&](int property) {
      return property >= 0 && is_list_of(vertex, property);
    };
    for (const int property : {x_, y_, z_, u_, v_})
      if (is_list(property)) return invalid("a coordinate of the vertices is a list");
    if (auto found = find_attributes(vertex); !found) return found;
    for (std::size_t k = 0; k < normal_.size(); ++k) normal_[k] = vertex.find({normal_names[k]});
    has_normals_ = std::all_of(normal_.begin(), normal_.end(),
                               [&](int property) { return property >= 0 && !is_list(property); });
    return {};
  }

  Result<void> find_attributes(const PlyElement& vertex) {
    for (const std::string& name : names_) {
      const int place = vertex.find({name});
      if (place < 0 || is_list_of(vertex, place)) {
        std::vector<std::string> numbers;
        for (const Property& property : vertex.properties) {
          if (!property.count_type) numbers.push_back(property.name);
        }
        return invalid(fmt::format("the vertices have no number {}; they have {}", in_quotes(name),
                                   listed_names(numbers)));
      }
      attributes_.push_back(place);
      mesh_.attributes.push_back({name, {}});
    }
    return {};
  }

  Result<void> find_face_properties(const PlyElement& face) {
    corners_ = face.find({"vertex_indices", "vertex_index"});
    if (corners_ < 0 || !is_list_of(face, corners_)) {
      return invalid(fmt::format("the {} have no list vertex_indices",
                                 face.name == "face" ? "faces" : face.name));
    }
    const auto find_list = [&](std::string_view name) {
      const int place = face.find({name});
      return place >= 0 && is_list_of(face, place) ? place : -1;
    };
    corner_uvs_ = has_numbered_uvs_ ? -1 : find_list("texcoord");
    uv_numbers_of_face_ = has_numbered_uvs_ ? find_list(uv_indices) : -1;
    normals_of_face_ = find_list(normal_indices);
    return {};
  }

  Result<void> read_values(const PlyElement& element, std::int64_t index, Values& values) {
    for (std::size_t k = 0; k < element.properties.size(); ++k) {
      const Property& property = element.properties[k];
      const auto count = property.count_type ? numbers_.next(*property.count_type) : 1.0;
      if (!count || *count < 0 || *count != std::floor(*count)) return no_number(element, index, k);
      if (*count > static_cast<double>(numbers_.room(property.type)))
        return ends_within(element, index);
      values[k].clear();
      for (double n = 0; n < *count; ++n) {
        const auto number = numbers_.next(property.type);
        if (poll_.after(parts_of_number)) return interrupted();
        const bool is_needed =
            std::find(needed_.begin(), needed_.end(), static_cast<int>(k)) != needed_.end();
        if (!number && (is_needed || numbers_.has_run_out())) return no_number(element, index, k);
        values[k].push_back(number.value_or(not_a_number));
      }
    }
    return {};
  }

  tl::unexpected<Error> no_number(const PlyElement& element, std::int64_t index,
                                  std::size_t property) {
    if (poll_.after(0)) return interrupted();
    if (numbers_.has_run_out()) return ends_within(element, index);
    return invalid(fmt::format("{} {}: {} is not a finite number", in_quotes(element.name), index,
                               in_quotes(element.properties[property].name)),
                   line());
  }

  tl::unexpected<Error> ends_within(const PlyElement& element, std::int64_t index) const {
    return invalid(fmt::format("the file is truncated: it ends within {} {} of {}, counted from 0",
                               in_quotes(element.name), index, element.count),
                   line());
  }

  void add_vertex(const Values& values) {
    const auto number = [&](int property) { return values[static_cast<std::size_t>(property)][0]; };
    coordinates_.insert(coordinates_.end(), {number(x_), number(y_), number(z_)});
    if (u_ >= 0) mesh_.uvs.push_back({number(u_), number(v_)});
    for (std::size_t k = 0; k < attributes_.size(); ++k)
      mesh_.attributes[k].values.push_back(number(attributes_[k]));
    if (!has_normals_) return;
    std::array<double, 3> normal = {number(normal_[0]), number(normal_[1]), number(normal_[2])};
    if (!std::all_of(normal.begin(), normal.end(), [](double x) { return std::isfinite(x); }))
      normal = {};
    normals_.push_back(normal);
  }

  Result<void> add_face(const Values& values, std::int64_t index) {
    const std::vector<double>& corners = values[static_cast<std::size_t>(corners_)];
    if (corners.size() < 3) {
      left_out_.add(small_face, small_faces);
      return {};
    }
    const auto list = [&](int property, std::size_t size, std::string_view one,
                          std::string_view several) {
      std::span<const double> numbers;
      if (property >= 0) numbers = values[static_cast<std::size_t>(property)];
      if (numbers.empty() || numbers.size() == size) return numbers;
      left_out_.add(one, several);
      return std::span<const double>();
    };
    constexpr std::string_view uv_list = "list of texture coordinates that does not suit its face",
                               uv_lists =
                                   "lists of texture coordinates that do not suit their faces";
    const CornerLists lists = {
        .uvs = list(corner_uvs_, 2 * corners.size(), uv_list, uv_lists),
        .uv_numbers = list(uv_numbers_of_face_, corners.size(), uv_list, uv_lists),
        .normals =
            list(normals_of_face_, corners.size(), "list of normals that does not suit its face",
                 "lists of normals that do not suit their faces")};
    return add_corners(corners, lists, "face", index);
  }

  // Triangles of three corners in a row, every second one the other way round; -1 ends a strip. One
  // with a corner twice only leads from one strip to the next.
  Result<void> add_strip(const Values& values, std::int64_t index) {
    const std::vector<double>& list = values[static_cast<std::size_t>(corners_)];
    std::size_t first = 0;
    for (std::size_t k = 0; k < list.size(); ++k) {
      if (list[k] == -1) first = k + 1;
      if (k < first + 2) continue;
      std::array<double, 3> corners = {list[k - 2], list[k - 1], list[k]};
      if ((k - first) % 2 == 1) std::swap(corners[0], corners[1]);
      const auto& [a, b, c] = corners;
      if (a == b || b == c || c == a) continue;
      if (auto added = add_corners(corners, {}, "strip", index); !added) return added;
    }
    return {};
  }

  // What a face has of its corners; empty: nothing.
  struct CornerLists {
    std::span<const double> uvs = {};         // u v of each
    std::span<const double> uv_numbers = {};  // -1: none
    std::span<const double> normals = {};     // equal: shared
  };

  Result<void> add_corners(std::span<const double> corners, const CornerLists& lists,
                           const char* element, std::int64_t index) {
    constexpr int most = std::numeric_limits<int>::max();
    if (poll_.after(parts_of_number * corners.size())) return interrupted();
    if (corners.size() > static_cast<std::size_t>(most) - mesh_.corner_vertices.size())
      return invalid(fmt::format("the faces have more than {} corners", most));
    mesh_.face_sizes.push_back(static_cast<int>(corners.size()));
    faces_.push_back({element, index});
    const auto to_index = [](double number) {
      const bool is_index =
          number >= 0 && number < static_cast<double>(most) && number == std::floor(number);
      return is_index ? std::optional(static_cast<int>(number)) : std::nullopt;
    };
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const int vertex = to_index(corners[k]).value_or(-1);
      mesh_.corner_vertices.push_back(vertex);
      // Vertices' (u,v) are known only in check_indices: faces may come before vertices.
      const bool has_own = !lists.uvs.empty();
      mesh_.corner_uvs.push_back(has_own ? static_cast<int>(corner_pairs_.size()) : -1);
      if (has_own) corner_pairs_.push_back({lists.uvs[2 * k], lists.uvs[2 * k + 1]});
      if (has_numbered_uvs_) {
        const double number = lists.uv_numbers.empty() ? -1 : lists.uv_numbers[k];
        mesh_.corner_uvs.back() = number == -1 ? -1 : to_index(number).value_or(most);
      }
      if (!has_numbered_normals_) continue;
      const bool has_normal = !lists.normals.empty() && lists.normals[k] >= 0;
      normal_numbers_.push_back(has_normal ? lists.normals[k] : -1.0 - vertex);
    }
    return {};
  }

  static std::string outside(int vertex, std::size_t count) {
    if (vertex < 0) return "an invalid vertex number; vertices are counted from 0";
    return fmt::format("vertex {}, but the file has {}", vertex, count);
  }

  // Corners without (u,v) of their own use the vertex's.
  Result<void> check_indices() {
    const std::size_t vertex_count = coordinates_.size() / 3;
    if (has_numbered_uvs_) mesh_.uvs = std::move(numbered_uvs_);
    const auto first_pair = has_numbered_uvs_ ? 0 : static_cast<int>(mesh_.uvs.size());
    std::size_t corner = 0;
    for (std::size_t face = 0; face < mesh_.face_sizes.size(); ++face) {
      if (poll_.after(static_cast<std::size_t>(mesh_.face_sizes[face]))) return interrupted();
      for (int k = 0; k < mesh_.face_sizes[face]; ++k, ++corner) {
        const int vertex = mesh_.corner_vertices[corner];
        if (vertex < 0 || static_cast<std::size_t>(vertex) >= vertex_count) {
          const auto& [element, index] = faces_[face];
          return invalid(fmt::format("corner {} of {} {} refers to {}", k, element, index,
                                     outside(vertex, vertex_count)));
        }
        int& uv = mesh_.corner_uvs[corner];
        if (has_numbered_uvs_ && uv >= static_cast<std::int64_t>(mesh_.uvs.size())) {
          uv = -1;
          left_out_.add("number of texture coordinates that is out of range",
                        "numbers of texture coordinates that are out of range");
        } else if (uv >= 0) {
          uv += first_pair;
        } else if (first_pair > 0) {
          uv = vertex;
        }
      }
    }
    mesh_.uvs.insert(mesh_.uvs.end(), corner_pairs_.begin(), corner_pairs_.end());
    return {};
  }

  int line() const { return numbers_.line(); }

  const Header& header_;
  std::span<const std::string> names_;  // of attributes
  const StopRequest& should_stop_;
  StopPoll poll_;
  Numbers numbers_;
  Mesh mesh_;
  std::vector<double> coordinates_;                  // x y z of each vertex
  std::vector<std::array<double, 3>> normals_;       // of each vertex, if it has one
  std::vector<std::array<double, 2>> corner_pairs_;  // (u,v) of corners
  bool has_numbered_uvs_ = false, has_numbered_normals_ = false;
  std::vector<std::array<double, 2>> numbered_uvs_;          // that corners refer to
  std::vector<double> normal_numbers_;                       // of corners; equal: shared
  std::vector<std::pair<const char*, std::int64_t>> faces_;  // element and index of each face kept
  int x_ = -1, y_ = -1, z_ = -1, u_ = -1, v_ = -1;           // properties of a vertex
  std::array<int, 3> normal_ = {-1, -1, -1};                 // likewise
  bool has_normals_ = false;
  std::vector<int> attributes_;  // likewise, of each name
  // Properties of a face.
  int corners_ = -1, corner_uvs_ = -1, uv_numbers_of_face_ = -1, normals_of_face_ = -1;
  std::vector<int> needed_;  // properties of an element that must be finite numbers
  LeftOut left_out_;
};

Result<Mesh> parse(std::string_view bytes, const std::string& object,
                   std::span<const std::string> attributes, const StopRequest& should_stop) {
  const auto header = read_header(bytes, should_stop);
  if (!header) return fail(header.error());
  auto mesh = PlyReader(*header, bytes.substr(header->size), attributes, should_stop).read();
  if (!mesh) return mesh;
  const std::array<std::string_view, 1> names = {""};
  if (const auto chosen = choose_object(names, {}, object); !chosen) return fail(chosen.error());
  return mesh;
}

}  // namespace

Result<Mesh> parse_ply(std::string_view bytes, const std::string& name, const std::string& object,
                       std::span<const std::string> attributes, const StopRequest& should_stop) {
  return about_mesh_file(name, [&] { return parse(bytes, object, attributes, should_stop); });
}

Result<Mesh> read_ply(const std::filesystem::path& file, const std::string& object,
                      std::span<const std::string> attributes, const StopRequest& should_stop) {
  const auto bytes = read_file(file, largest_mesh_file, should_stop);
  if (!bytes) return fail(bytes.error());
  return parse_ply(*bytes, file.string(), object, attributes, should_stop);
}

Result<std::vector<FileObject>> ply_objects(const std::filesystem::path& file,
                                            const StopRequest& should_stop) {
  const auto mesh = read_ply(file, {}, {}, should_stop);
  if (!mesh) return fail(mesh.error());
  std::vector<FileObject> objects(1);
  objects[0].vertices = static_cast<std::uint64_t>(mesh->vertex_count());
  objects[0].faces = mesh->face_sizes.size();
  set_choices({}, objects);
  return objects;
}

}  // namespace pliant
