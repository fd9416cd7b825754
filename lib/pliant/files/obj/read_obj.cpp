#include "pliant/files/obj/read_obj.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/text.hpp"
#include "pliant/files/file_object.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/mesh/face_names.hpp"
#include "pliant/mesh/normals.hpp"

namespace pliant {
namespace {

constexpr std::size_t max_errors = 20;

// Whether a word begins a statement of the format, including statements that are skipped.
bool is_keyword(std::string_view word) {
  constexpr std::string_view keywords[] = {
      "v",    "vt",    "vn",    "vp",     "p",          "l",        "f",        "o",
      "g",    "s",     "mg",    "usemtl", "mtllib",     "usemap",   "maplib",   "cstype",
      "deg",  "bmat",  "step",  "curv",   "curv2",      "surf",     "parm",     "trim",
      "hole", "scrv",  "sp",    "end",    "con",        "bevel",    "c_interp", "d_interp",
      "lod",  "ctech", "stech", "call",   "csh",        "bzp",      "bsp",      "res",
      "cdc",  "cdp",   "fo",    "cstech", "shadow_obj", "trace_obj"};
  return std::find(std::begin(keywords), std::end(keywords), word) != std::end(keywords);
}

// The faces that follow one `o` statement.
struct Object {
  std::string name;
  std::size_t first_face = 0;
};

class ObjReader {
 public:
  ObjReader(const std::string& name, const StopRequest& should_stop)
      : name_(name), should_stop_(should_stop), poll_(should_stop) {}

  void read(std::string_view text) {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // the byte order mark
    std::string joined;  // a statement continued by backslashes at line ends
    int line = 0;
    int first_line = 1;
    while (!text.empty() && errors_.size() < max_errors && !is_refused_) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      if (poll_.after(parts_of_line + end)) return;
      std::string_view statement = trim(text.substr(0, end), ascii_blanks);
      text.remove_prefix(std::min(end + 1, text.size()));
      ++line;
      if (joined.empty()) first_line = line;
      line_ = first_line;
      if (joined.size() + end > longest_statement)
        return refuse(fmt::format("the statement is longer than {} MiB", longest_statement >> 20));
      if (statement.ends_with('\\') && !text.empty()) {
        statement.remove_suffix(1);
        joined.append(statement).push_back(' ');
        continue;
      }
      if (joined.empty()) {
        read_statement(statement);
      } else {
        joined.append(statement);
        read_statement(joined);
        joined.clear();
      }
    }
  }

  Result<std::vector<FileObject>> objects() {
    if (auto checked = check_faces(); !checked) return fail(checked.error());
    const std::vector<Range> ranges = ranges_of_objects();
    std::vector<FileObject> objects;
    std::vector<std::size_t> last_user(coordinates_.size() / 3);  // an object, counted from 1
    std::size_t corner = 0, face = 0;
    for (const Range& range : ranges) {
      FileObject& object = objects.emplace_back();
      object.name = range.name;
      object.faces = range.last - range.first;
      for (; face < range.last; ++face) {
        if (poll_.after(static_cast<std::size_t>(mesh_.face_sizes[face]))) return interrupted();
        for (int k = 0; k < mesh_.face_sizes[face]; ++k) {
          std::size_t& user = last_user[mesh_.corner_vertices[corner++]];
          if (user != objects.size()) ++object.vertices;
          user = objects.size();
        }
      }
    }
    if (objects.size() == 1) objects[0].vertices = last_user.size();  // as `select` takes them
    set_choices({}, objects);
    return objects;
  }

  Result<Mesh> finish(const std::string& object) {
    if (auto checked = check_faces(); !checked) return fail(checked.error());
    left_out_.add("texture vertex (vt) that is not a number",
                  "texture vertices (vt) that are not numbers", drop_invalid_uvs(mesh_));
    mesh_.left_out = left_out_.text();
    mesh_.positions = to_positions(coordinates_);
    return select(object);
  }

 private:
  static constexpr std::size_t longest_statement = std::size_t{16} << 20;
  static constexpr std::size_t parts_of_line = 64, parts_of_corner = 32;

  void read_statement(std::string_view statement) {
    const std::string_view keyword = next_word(statement, ascii_blanks);
    if (keyword.starts_with('#')) return;
    // A name goes to the end of its line, and may have a #.
    const bool is_named = keyword == "o" || keyword == "g" || keyword == "usemtl";
    if (!is_named) statement = statement.substr(0, statement.find('#'));
    // Checked before any text is quoted, as it may be of any file.
    if (!is_obj_ && !keyword.empty()) {
      is_obj_ = is_keyword(keyword);
      if (!is_obj_) return refuse("the file is not OBJ: no OBJ statement begins like this line");
    }
    if (keyword == "v") {
      read_vertex(statement);
    } else if (keyword == "vt") {
      read_texture_vertex(statement);
    } else if (keyword == "f") {
      read_face(statement);
    } else if (keyword == "l") {
      left_out_.add("line", "lines");
    } else if (keyword == "p") {
      while (!next_word(statement, ascii_blanks).empty() && !poll_.after(parts_of_corner))
        left_out_.add("point", "points");
    } else if (keyword == "o") {
      objects_.push_back({std::string(trim(statement, ascii_blanks)), mesh_.face_sizes.size()});
    } else if (keyword == "vn") {
      shading_.normals.push_back(read_normal(statement));
    } else if (keyword == "usemtl") {
      material_ = materials_.number_of(trim(statement, ascii_blanks));
    } else if (keyword == "g") {
      group_ = groups_.number_of(trim(statement, ascii_blanks));
    } else if (keyword == "s") {
      const std::string_view word = next_word(statement, ascii_blanks);
      const auto group = word == "off" ? Shading::flat : to_integer(word).value_or(-1);
      smoothing_ = group >= 0 ? group : Shading::unsaid;
    }
  }

  void refuse(std::string message) {
    add_error(line_, std::move(message));
    is_refused_ = true;
  }

  // Zeros if it cannot be parsed.
  static std::array<double, 3> read_normal(std::string_view words) {
    std::array<double, 3> normal{};
    for (double& component : normal) {
      const auto number = to_number(next_word(words, ascii_blanks));
      if (!number) return {};
      component = *number;
    }
    return normal;
  }

  // `v x y z [w]` or `v x y z r g b`. A line that cannot be parsed still counts, as zeros, so that
  // the indices of the faces stay right.
  void read_vertex(std::string_view words) {
    std::array<double, 3> place{};
    for (std::size_t k = 0; k < place.size(); ++k) {
      const std::string_view word = next_word(words, ascii_blanks);
      const auto number = to_number(word);
      if (!number) {
        add_error(
            line_,
            word.empty()
                ? fmt::format("vertex has {} numbers, but needs 3", k)
                : fmt::format("vertex has the coordinate {}, which is not a finite decimal number",
                              in_quotes(word)));
        place = {};
        break;
      }
      place[k] = *number;
    }
    coordinates_.insert(coordinates_.end(), place.begin(), place.end());
    constexpr int most_further = 4;
    if (!are_numbers(words, most_further))
      left_out_.add("vertex colour or further number that cannot be read",
                    "vertex colours or further numbers that cannot be read");
  }

  // `vt u [v [w]]`. One that cannot be parsed still counts: its corners then have no (u,v).
  void read_texture_vertex(std::string_view words) {
    const double u = to_number(next_word(words, ascii_blanks)).value_or(not_a_number);
    const std::string_view second = next_word(words, ascii_blanks);
    const double v = second.empty() ? 0 : to_number(second).value_or(not_a_number);
    mesh_.uvs.push_back({u, v});
    if (!are_numbers(words, 1)) {
      left_out_.add("further number of a texture vertex that cannot be read",
                    "further numbers of texture vertices that cannot be read");
    }
  }

  // Whether the words are numbers, and not more of them.
  static bool are_numbers(std::string_view words, int most) {
    for (std::string_view word = next_word(words, ascii_blanks); !word.empty();
         word = next_word(words, ascii_blanks))
      if (!to_number(word) || --most < 0) return false;
    return true;
  }

  // A corner's numbers as written: from 1, or negative, counted back from the last element so far.
  struct Corner {
    int vertex = 0;
    std::optional<int> uv = {};      // nullopt: the corner has no (u,v)
    std::optional<int> normal = {};  // likewise
  };

  // `v`, `v/vt`, `v//vn` or `v/vt/vn`, where the numbers after the first may be missing; nullopt
  // for anything else.
  std::optional<Corner> parse_corner(std::string_view word) {
    const std::size_t slash = word.find('/');
    const auto vertex = to_integer(word.substr(0, slash));
    if (!vertex) return std::nullopt;
    Corner corner{*vertex};
    if (slash == std::string_view::npos) return corner;
    const std::string_view rest = word.substr(slash + 1);
    const std::string_view texture = rest.substr(0, rest.find('/'));
    if (!texture.empty()) {
      corner.uv = to_integer(texture);
      if (!corner.uv) return std::nullopt;
    }
    const bool has_normal = texture.size() < rest.size();
    const std::string_view normal =
        has_normal ? rest.substr(texture.size() + 1) : std::string_view();
    if (!normal.empty()) {
      corner.normal = to_integer(normal);
      if (!corner.normal) return std::nullopt;
    }
    if (has_normal ? normal.empty() : texture.empty()) leave_out_reference();
    return corner;
  }

  void leave_out_reference() {
    left_out_.add("texture or normal number of a face corner that is missing or out of range",
                  "texture or normal numbers of face corners that are missing or out of range");
  }

  void read_face(std::string_view words) {
    const std::size_t first_corner = mesh_.corner_vertices.size();
    for (std::string_view word = next_word(words, ascii_blanks); !word.empty();
         word = next_word(words, ascii_blanks)) {
      if (poll_.after(parts_of_corner)) return drop_corners(first_corner);
      const auto corner = parse_corner(word);
      if (!corner) {
        drop_corners(first_corner);
        return add_error(line_, fmt::format("face corner {} is not of the form v, v/vt, v//vn or "
                                            "v/vt/vn",
                                            in_quotes(word)));
      }
      mesh_.corner_vertices.push_back(to_index(corner->vertex, coordinates_.size() / 3));
      mesh_.corner_uvs.push_back(corner->uv ? to_index(*corner->uv, mesh_.uvs.size()) : -1);
      shading_.corner_normals.push_back(
          corner->normal ? to_index(*corner->normal, shading_.normals.size()) : -1);
    }
    const std::size_t size = mesh_.corner_vertices.size() - first_corner;
    if (size < 3) {
      drop_corners(first_corner);
      return left_out_.add(small_face, small_faces);
    }
    mesh_.face_sizes.push_back(static_cast<int>(size));
    face_lines_.push_back(line_);
    shading_.smoothing.push_back(smoothing_);
    materials_.add_faces(material_);
    groups_.add_faces(group_);
  }

  void drop_corners(std::size_t first) {
    mesh_.corner_vertices.resize(first);
    mesh_.corner_uvs.resize(first);
    shading_.corner_normals.resize(first);
  }

  // From 1, or negative, counted back from the last element so far. Numbers out of range stay out
  // of range, so that check_indices, which knows all vertices, finds them: missing_index for 0 and
  // for numbers too far back.
  static int to_index(int written, std::size_t count) {
    if (written > 0) return written - 1;
    const std::int64_t index = static_cast<std::int64_t>(count) + written;
    return written == 0 || index < 0 ? missing_index : static_cast<int>(index);
  }

  static std::string outside(int index, std::size_t count) {
    if (index == missing_index) return "a vertex before the file's first";
    return fmt::format("vertex {}, but the file has {}", index + 1, count);
  }

  // Whether there are faces whose vertices exist. References to (u,v) and normals that do not exist
  // count as none.
  Result<void> check_faces() {
    const std::size_t vertex_count = coordinates_.size() / 3;
    std::size_t corner = 0;
    for (std::size_t face = 0; face < face_lines_.size() && errors_.size() < max_errors; ++face) {
      if (poll_.after(static_cast<std::size_t>(mesh_.face_sizes[face]))) break;
      const auto corners = std::span(mesh_.corner_vertices)
                               .subspan(corner, static_cast<std::size_t>(mesh_.face_sizes[face]));
      corner += corners.size();
      const auto wrong = std::ranges::find_if_not(
          corners, [&](int vertex) { return is_within(vertex, vertex_count); });
      if (wrong == corners.end()) continue;
      add_error(face_lines_[face],
                fmt::format("corner {} of the face refers to {}", wrong - corners.begin() + 1,
                            outside(*wrong, vertex_count)));
    }
    drop_references(mesh_.corner_uvs, mesh_.uvs.size());
    drop_references(shading_.corner_normals, shading_.normals.size());
    if (poll_.after(0)) return interrupted();
    if (errors_.empty() && mesh_.face_sizes.empty()) add_error(0, "the file has no faces (f)");
    if (!errors_.empty()) return failure();
    return {};
  }

  void drop_references(std::vector<int>& indices, std::size_t count) {
    for (int& index : indices) {
      if (poll_.after() || index == -1 || is_within(index, count)) continue;
      index = -1;
      leave_out_reference();
    }
  }

  static bool is_within(int index, std::size_t count) {
    return index >= 0 && static_cast<std::size_t>(index) < count;
  }

  struct Range {
    std::string name;
    std::size_t first, last;  // faces
  };

  // Objects with faces, each up to the next one; faces before the first `o` have no name.
  std::vector<Range> ranges_of_objects() {
    std::vector<Range> ranges;
    if (objects_.empty() || objects_.front().first_face > 0)
      objects_.insert(objects_.begin(), {"", 0});
    for (std::size_t k = 0; k < objects_.size(); ++k) {
      const std::size_t last =
          k + 1 < objects_.size() ? objects_[k + 1].first_face : mesh_.face_sizes.size();
      if (last > objects_[k].first_face)
        ranges.push_back({objects_[k].name, objects_[k].first_face, last});
    }
    return ranges;
  }

  Result<Mesh> select(const std::string& object) {
    const std::vector<Range> ranges = ranges_of_objects();
    std::vector<std::string_view> names;
    names.reserve(ranges.size());
    for (const Range& range : ranges) names.push_back(range.name);
    const auto chosen = choose_object(names, {}, object);
    if (!chosen) {
      add_error(0, chosen.error().message);
      return failure();
    }
    auto shared = shared_normals(mesh_, shading_, should_stop_);
    if (!shared) return fail(shared.error());
    mesh_.corner_normals = *std::move(shared);
    const Range& range = ranges[*chosen];
    Mesh mesh = ranges.size() == 1 ? std::move(mesh_) : part(range.first, range.last);
    mesh.object = range.name;
    mesh.first_index = 1;
    mesh.materials = part_of(materials_.names(), range.first, range.last);
    mesh.groups = part_of(groups_.names(), range.first, range.last);
    return mesh;
  }

  // The faces first..last with the vertices that they use.
  Mesh part(std::size_t first, std::size_t last) const {
    std::size_t corner = 0;
    for (std::size_t face = 0; face < first; ++face) corner += mesh_.face_sizes[face];
    std::size_t end = corner;
    for (std::size_t face = first; face < last; ++face) end += mesh_.face_sizes[face];

    std::vector<int> new_index(static_cast<std::size_t>(mesh_.vertex_count()), -1);
    for (std::size_t k = corner; k < end; ++k) new_index[mesh_.corner_vertices[k]] = 0;
    int count = 0;
    for (int& index : new_index) index = index < 0 ? -1 : count++;

    Mesh result;
    result.left_out = mesh_.left_out;
    result.uvs = mesh_.uvs;
    result.positions.resize(count, 3);
    for (int vertex = 0; vertex < mesh_.vertex_count(); ++vertex) {
      if (new_index[vertex] >= 0) {
        result.positions.row(new_index[vertex]) = mesh_.positions.row(vertex);
        result.file_vertices.push_back(vertex);
      }
    }
    result.face_sizes.assign(mesh_.face_sizes.begin() + static_cast<std::ptrdiff_t>(first),
                             mesh_.face_sizes.begin() + static_cast<std::ptrdiff_t>(last));
    for (std::size_t k = corner; k < end; ++k) {
      result.corner_vertices.push_back(new_index[mesh_.corner_vertices[k]]);
      result.corner_uvs.push_back(mesh_.corner_uvs[k]);
    }
    if (mesh_.corner_normals.empty()) return result;
    std::vector<int> new_normal(mesh_.corner_normals.size(), -1);  // excludes other objects'
    count = 0;
    for (std::size_t k = corner; k < end; ++k) {
      int& normal = new_normal[static_cast<std::size_t>(mesh_.corner_normals[k])];
      if (normal < 0) normal = count++;
      result.corner_normals.push_back(normal);
    }
    return result;
  }

  void add_error(int line, std::string message) {
    errors_.push_back({ErrorCode::InvalidInput, std::move(message), name_, line, {}});
  }

  tl::unexpected<Error> failure() const {
    Error first = errors_.front();
    first.others.assign(errors_.begin() + 1, errors_.end());
    return fail(std::move(first));
  }

  static constexpr int missing_index = -2;
  static constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

  std::string name_;
  const StopRequest& should_stop_;
  StopPoll poll_;
  int line_ = 0;
  bool is_obj_ = false;      // the first statement is one of the format
  bool is_refused_ = false;  // nothing more is read
  Mesh mesh_;
  std::vector<double> coordinates_;  // x y z of each vertex
  std::vector<int> face_lines_;
  std::vector<Object> objects_;
  Shading shading_;
  int smoothing_ = Shading::unsaid;
  NamedFaces materials_, groups_;
  int material_ = -1, group_ = -1;  // of the faces that follow
  std::vector<Error> errors_;
  LeftOut left_out_;
};

}  // namespace

Result<Mesh> parse_obj(std::string_view text, const std::string& name, const std::string& object,
                       const StopRequest& should_stop) {
  ObjReader reader(name, should_stop);
  reader.read(text);
  return reader.finish(object);
}

Result<Mesh> read_obj(const std::filesystem::path& file, const std::string& object,
                      const StopRequest& should_stop) {
  const auto text = read_file(file, largest_mesh_file, should_stop);
  if (!text) return fail(text.error());
  return parse_obj(*text, file.string(), object, should_stop);
}

Result<std::vector<FileObject>> obj_objects(const std::filesystem::path& file,
                                            const StopRequest& should_stop) {
  const auto text = read_file(file, largest_mesh_file, should_stop);
  if (!text) return fail(text.error());
  ObjReader reader(file.string(), should_stop);
  reader.read(*text);
  return reader.objects();
}

}  // namespace pliant
