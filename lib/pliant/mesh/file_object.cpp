#include "pliant/mesh/file_object.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/core/transform.hpp"

namespace pliant {
namespace {

constexpr std::size_t most_listed = 10;

// How much the last row of a transform may differ from 0 0 0 1: exporters work in float.
constexpr double affine_tolerance = 1e-5;

}  // namespace

std::string in_quotes(std::string_view text) {
  constexpr std::size_t longest = 40;
  std::string quoted(text.substr(0, longest));
  for (char& c : quoted)  // a message is one line
    if ((c >= 0 && c < ' ') || c == '\x7f') c = '?';
  return fmt::format("\"{}{}\"", quoted, text.size() > longest ? "…" : "");
}

std::string listed_names(std::span<const std::string> names) {
  std::string list;
  for (const std::string& name : names.first(std::min(names.size(), most_listed)))
    list += (list.empty() ? "" : ", ") + in_quotes(name);
  if (names.size() > most_listed) list += fmt::format(", … ({} in all)", names.size());
  return list;
}

Result<std::size_t> choose_object(std::span<const std::string> names, const std::string& object) {
  PLIANT_EXPECTS(!names.empty());
  if (object.empty()) {
    if (names.size() == 1) return 0;
    return fail(ErrorCode::InvalidInput,
                fmt::format("the file has {} objects; choose one with the attribute object: {}",
                            names.size(), listed_names(names)));
  }
  const auto found = std::find(names.begin(), names.end(), object);
  if (found == names.end()) {
    return fail(ErrorCode::InvalidInput, fmt::format("the file has no object {}; it has: {}",
                                                     in_quotes(object), listed_names(names)));
  }
  if (const auto count = std::count(found, names.end(), object); count > 1) {
    return fail(ErrorCode::InvalidInput,
                fmt::format("the file has {} objects named {}; give them different names", count,
                            in_quotes(object)));
  }
  return static_cast<std::size_t>(found - names.begin());
}

Result<std::size_t> choose_node(std::span<const std::string> nodes,
                                std::span<const std::string> meshes, const std::string& object) {
  PLIANT_EXPECTS(nodes.size() == meshes.size());
  if (nodes.empty()) return invalid("the file has no faces");
  const bool is_node = std::find(nodes.begin(), nodes.end(), object) != nodes.end();
  const bool is_mesh = std::find(meshes.begin(), meshes.end(), object) != meshes.end();
  return choose_object(!object.empty() && !is_node && is_mesh ? meshes : nodes, object);
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

Result<void> check_uv_set(int uv_set, int set_count) {
  if (uv_set == 0 || uv_set < set_count) return {};
  return fail(ErrorCode::InvalidInput,
              fmt::format("the object has {} UV set{}, so there is no set {} (counted from 0)",
                          set_count, set_count == 1 ? "" : "s", uv_set));
}

}  // namespace pliant
