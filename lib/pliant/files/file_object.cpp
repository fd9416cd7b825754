#include "pliant/files/file_object.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/text.hpp"
#include "pliant/core/transform.hpp"
#include "pliant/files/object_choice.hpp"

namespace pliant {
namespace {

constexpr std::size_t most_listed = 10;

// How much the last row of a transform may differ from 0 0 0 1: exporters work in float.
constexpr double affine_tolerance = 1e-5;

// Whether an attribute of a scene can have this text as it is, where a $ begins a definition.
bool is_writable(std::string_view name) {
  return !name.empty() && is_utf8(name) && std::none_of(name.begin(), name.end(), [](char c) {
    return (c >= 0 && c < ' ') || c == '$';
  });
}

}  // namespace

Error in_file(Error error, const std::string& file) {
  if (error.code != ErrorCode::Interrupted) error.file = file;
  return error;
}

std::string listed_names(std::span<const std::string> names) {
  std::string list;
  for (const std::string& name : names.first(std::min(names.size(), most_listed)))
    list += (list.empty() ? "" : ", ") + in_quotes(name);
  if (names.size() > most_listed) list += fmt::format(", … ({} in all)", names.size());
  return list;
}

Result<std::size_t> choose_object(std::span<const std::string_view> names,
                                  std::span<const std::string_view> meshes,
                                  const std::string& object) {
  if (names.empty()) return invalid("the file has no faces");
  const ObjectMatch match = find_objects(names, meshes, object);
  if (match.count == 1) return match.first;
  if (match.count > 1 && !object.empty()) {
    return invalid(fmt::format("the file has {} objects named {}; choose one by its number: {}",
                               match.count, in_quotes(object), in_quotes(object + "#1")));
  }
  std::vector<FileObject> objects;
  for (const std::string_view name : names) objects.push_back({.name = std::string(name)});
  set_choices(meshes, objects);
  std::vector<std::string> choices;
  for (FileObject& each : objects) choices.push_back(std::move(each.choice));
  const std::string list = listed_names(choices) + "; `pliant info FILE` lists all of them whole";
  return invalid(
      object.empty()
          ? fmt::format("the file has {} objects; choose one with the attribute object: {}",
                        names.size(), list)
          : fmt::format("the file has no object {}; it has: {}", in_quotes(object), list));
}

// O(n log n), where asking `find_objects` for each of a million objects would be O(n²).
void set_choices(std::span<const std::string_view> meshes, std::vector<FileObject>& objects) {
  std::map<std::string_view, std::size_t> counts, so_far;
  for (const FileObject& each : objects) ++counts[each.name];
  const std::set<std::string_view> mesh_names(meshes.begin(), meshes.end());
  const auto is_free = [&](const std::string& text) {
    return !counts.contains(text) && !mesh_names.contains(text);
  };
  for (std::size_t k = 0; k < objects.size(); ++k) {
    FileObject& each = objects[k];
    const bool is_only = counts[each.name] == 1;
    each.choice = is_only ? each.name : fmt::format("{}#{}", each.name, ++so_far[each.name]);
    if (is_writable(each.name) && (is_only || is_free(each.choice))) continue;
    // Zeros ahead of the number change nothing, but tell it from an object of that name.
    for (std::string zeros; !is_free(each.choice = fmt::format("#{}{}", zeros, k + 1));)
      zeros += '0';
  }
}

Result<void> to_file_space(const Eigen::Matrix4d& to_file, Mesh& mesh) {
  if (to_file == Eigen::Matrix4d::Identity()) return {};  // otherwise -0 would become 0
  const Eigen::RowVector4d last_row = to_file.row(3);
  if (!((last_row - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() <= affine_tolerance)) {
    return invalid(
        fmt::format("the object's transform is not affine: its last row is "
                    "{} {} {} {}, not 0 0 0 1",
                    last_row[0], last_row[1], last_row[2], last_row[3]));
  }
  const Transform transform{to_file.topLeftCorner<3, 3>(), to_file.topRightCorner<3, 1>()};
  mesh.positions = to_world(transform, mesh.positions);
  if (transform.is_mirrored()) turn_faces(mesh);
  return {};
}

Field to_positions(const std::vector<double>& coordinates) {
  return Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>(
      coordinates.data(), static_cast<Eigen::Index>(coordinates.size() / 3), 3);
}

int drop_invalid_uvs(Mesh& mesh) {
  std::vector<bool> is_invalid(mesh.uvs.size());
  int count = 0;
  for (std::size_t k = 0; k < mesh.uvs.size(); ++k) {
    is_invalid[k] = !std::isfinite(mesh.uvs[k][0]) || !std::isfinite(mesh.uvs[k][1]);
    if (!is_invalid[k]) continue;
    mesh.uvs[k] = {0, 0};
    ++count;
  }
  if (count == 0) return 0;
  for (int& uv : mesh.corner_uvs)
    if (uv >= 0 && is_invalid[static_cast<std::size_t>(uv)]) uv = -1;
  return count;
}

void LeftOut::add(std::string_view one, std::string_view several, std::int64_t count) {
  if (count == 0) return;
  const auto known = std::ranges::find(kinds_, one, &Kind::one);
  if (known != kinds_.end()) {
    known->count += count;
  } else {
    kinds_.push_back({std::string(one), std::string(several), count});
  }
}

std::string LeftOut::text() const {
  std::vector<std::string> texts;
  for (const auto& [one, several, count] : kinds_)
    texts.push_back(fmt::format("{} {}", count, count == 1 ? one : several));
  return in_words(texts);
}

Result<void> check_uv_set(int uv_set, int set_count) {
  if (uv_set == 0 || uv_set < set_count) return {};
  return fail(ErrorCode::InvalidInput,
              fmt::format("the object has {} UV set{}, so there is no set {} (counted from 0)",
                          set_count, set_count == 1 ? "" : "s", uv_set));
}

}  // namespace pliant
