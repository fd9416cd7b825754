#include "pliant/output/usda_surface.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "pliant/mesh/normals.hpp"
#include "pliant/output/single_precision.hpp"
#include "pliant/output/usda_names.hpp"

namespace pliant {
namespace {

constexpr const char* indent = "        ";

void append_vector(float x, float y, float z, std::string& text) {
  fmt::format_to(std::back_inserter(text), "({}, {}, {})", x, y, z);
}

// Writes rows of three as [(x, y, z), …].
void append_vectors(std::span<const float> numbers, std::string& text) {
  text += '[';
  for (std::size_t k = 0; k < numbers.size(); k += 3) {
    if (k > 0) text += ", ";
    append_vector(numbers[k], numbers[k + 1], numbers[k + 2], text);
  }
  text += ']';
}

void append_integers(std::span<const int> numbers, std::string& text) {
  auto out = std::back_inserter(text);
  text += '[';
  for (std::size_t k = 0; k < numbers.size(); ++k)
    fmt::format_to(out, "{}{}", k > 0 ? ", " : "", numbers[k]);
  text += ']';
}

// The corners of the bounding box of the points.
void append_extent(std::span<const float> numbers, std::string& text) {
  float least[3] = {0, 0, 0}, largest[3] = {0, 0, 0};
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    least[k % 3] = k < 3 ? numbers[k] : std::min(least[k % 3], numbers[k]);
    largest[k % 3] = k < 3 ? numbers[k] : std::max(largest[k % 3], numbers[k]);
  }
  text += '[';
  append_vector(least[0], least[1], least[2], text);
  text += ", ";
  append_vector(largest[0], largest[1], largest[2], text);
  text += ']';
}

// The faces with each name, ascending.
std::vector<std::vector<int>> faces_of_names(const FaceNames& faces) {
  std::vector<std::vector<int>> members(faces.names.size());
  for (std::size_t face = 0; face < faces.of_faces.size(); ++face) {
    const int name = faces.of_faces[face];
    if (name >= 0) members[static_cast<std::size_t>(name)].push_back(static_cast<int>(face));
  }
  return members;
}

std::string sample_head(int frame) { return fmt::format("{}    {}: ", indent, frame); }

Result<void> append_samples(std::string_view attribute, SpoolFile& samples, AtomicFile& file) {
  const std::string head = fmt::format("{}{}.timeSamples = {{\n", indent, attribute);
  if (auto written = file.write(head); !written) return written;
  if (auto copied = samples.copy_to(file); !copied) return copied;
  return file.write(fmt::format("{}}}\n", indent));
}

// One axis after the other, as in xformOp:rotateXYZ: x first.
std::string rotate_operation(RotateOrder order) {
  std::string name = "xformOp:rotate";
  for (const int axis : axes(order)) name += static_cast<char>('X' + axis);
  return name;
}

}  // namespace

UsdaSurface::UsdaSurface(const AnimationPlan& plan, const AnimatedSurface& surface,
                         SpoolFile points, SpoolFile normals, SpoolFile velocities)
    : name_(surface.name),
      written_(*surface.mesh),
      mesh_(&written_.in_space(surface.is_mirrored)),
      first_frame_(plan.first_frame),
      last_frame_(plan.last_frame),
      fps_(plan.fps),
      is_placed_(plan.is_placed),
      points_(std::move(points)),
      normals_(std::move(normals)),
      velocities_(std::move(velocities)) {}

Result<UsdaSurface> UsdaSurface::make(const AnimationPlan& plan, const AnimatedSurface& surface) {
  auto points = SpoolFile::create(plan.file);
  if (!points) return fail(points.error());
  auto normals = SpoolFile::create(plan.file);
  if (!normals) return fail(normals.error());
  auto velocities = SpoolFile::create(plan.file);
  if (!velocities) return fail(velocities.error());
  UsdaSurface made(plan, surface, *std::move(points), *std::move(normals), *std::move(velocities));
  const auto rest = to_single(surface.rest, plan.first_frame, surface.mesh->first_index);
  if (!rest) return fail(rest.error());
  append_vectors(*rest, made.rest_);
  return made;
}

Result<void> UsdaSurface::add(const SurfacePose& pose, int frame) {
  if (is_placed_) {
    auto held = check_placement(pose.placement, PlacementNumbers::Double, name_, frame);
    if (!held) return held;
  }
  const auto numbers = to_single(pose.positions, frame, mesh_->first_index);
  if (!numbers) return fail(numbers.error());
  std::string text = sample_head(frame);
  append_vectors(*numbers, text);
  text += ",\n";
  if (auto written = points_.write(text); !written) return written;

  extents_ += sample_head(frame);
  append_extent(*numbers, extents_);
  extents_ += ",\n";

  text = sample_head(frame);
  const Field normals = unit_normals(*mesh_, pose.positions);
  Field rows;  // one per corner if not one per vertex
  if (!mesh_->corner_normals.empty()) {
    rows.resize(static_cast<Eigen::Index>(mesh_->corner_normals.size()), 3);
    for (Eigen::Index k = 0; k < rows.rows(); ++k)
      rows.row(k) = normals.row(mesh_->corner_normals[static_cast<std::size_t>(k)]);
  }
  const auto directions = to_single(mesh_->corner_normals.empty() ? normals : rows, frame);
  if (!directions) return fail(directions.error());
  append_vectors(*directions, text);
  text += ",\n";
  if (auto written = normals_.write(text); !written) return written;

  if (last_) {
    const Field way = pose.positions - *last_;
    if (auto added = add_velocities(frame - 1, way); !added) return added;
    if (frame == last_frame_) {
      if (auto added = add_velocities(frame, way); !added) return added;
    }
  }
  last_ = pose.positions;
  if (is_placed_) add_placement(pose.placement);
  return {};
}

Result<void> UsdaSurface::add_velocities(int frame, const Field& way) {
  const auto numbers = to_single(way * fps_, frame);
  if (!numbers) return fail(numbers.error());
  std::string text = sample_head(frame);
  append_vectors(*numbers, text);
  text += ",\n";
  return velocities_.write(text);
}

void UsdaSurface::add_placement(const Placement& placement) {
  if (operations_.empty()) {
    operations_ = {{"double3", "xformOp:translate"},
                   {"double3", rotate_operation(placement.order)},
                   {"double3", "xformOp:scale"}};
  }
  const Vector3d* const parts[] = {&placement.translate, &placement.rotate, &placement.scale};
  for (std::size_t k = 0; k < operations_.size(); ++k) {
    const Vector3d& v = *parts[k];
    operations_[k].samples.push_back(fmt::format("({}, {}, {})", v[0], v[1], v[2]));
  }
}

std::string UsdaSurface::head(const std::string& name) const {
  std::string text = fmt::format("    def Mesh \"{}\" (\n", name);
  if (name != name_) text += fmt::format("{}displayName = {}\n", indent, usda_string(name_));
  if (!mesh_->materials.names.empty())
    text += fmt::format("{}prepend apiSchemas = [\"MaterialBindingAPI\"]\n", indent);
  text += "    )\n    {\n";
  return text +
         fmt::format("{0}uniform bool doubleSided = 1\n{0}float3[] extent.timeSamples = {{\n",
                     indent) +
         extents_ + indent + "}\n";
}

std::string UsdaSurface::topology() const {
  std::string text = fmt::format("{}int[] faceVertexCounts = ", indent);
  append_integers(mesh_->face_sizes, text);
  text += fmt::format("\n{}int[] faceVertexIndices = ", indent);
  append_integers(mesh_->corner_vertices, text);
  text += fmt::format(
      "\n{0}uniform token orientation = \"rightHanded\"\n"
      "{0}uniform token subdivisionScheme = \"none\"\n",
      indent);
  return text;
}

std::string UsdaSurface::uvs() const {
  if (std::all_of(mesh_->corner_uvs.begin(), mesh_->corner_uvs.end(),
                  [](int uv) { return uv < 0; })) {
    return {};
  }
  // A corner without (u,v) gets (0,0) if others have them.
  std::vector<int> indices = mesh_->corner_uvs;
  const auto origin = static_cast<int>(mesh_->uvs.size());
  const bool has_gaps = std::find(indices.begin(), indices.end(), -1) != indices.end();
  std::replace(indices.begin(), indices.end(), -1, origin);
  std::string text = fmt::format("{}texCoord2f[] primvars:st = [", indent);
  auto out = std::back_inserter(text);
  for (std::size_t k = 0; k < mesh_->uvs.size(); ++k) {
    fmt::format_to(out, "{}({}, {})", k > 0 ? ", " : "", static_cast<float>(mesh_->uvs[k][0]),
                   static_cast<float>(mesh_->uvs[k][1]));
  }
  if (has_gaps) text += ", (0, 0)";
  text += fmt::format("] (\n{0}    interpolation = \"faceVarying\"\n{0})\n", indent);
  text += fmt::format("{}int[] primvars:st:indices = ", indent);
  append_integers(indices, text);
  return text + '\n';
}

std::string UsdaSurface::placement() const {
  if (operations_.empty()) return {};
  std::string text, order;
  for (const Operation& operation : operations_) {
    const bool is_moving =
        std::any_of(operation.samples.begin(), operation.samples.end(),
                    [&](const std::string& sample) { return sample != operation.samples[0]; });
    if (is_moving) {
      text += fmt::format("{}{} {}.timeSamples = {{\n", indent, operation.type, operation.name);
      for (std::size_t k = 0; k < operation.samples.size(); ++k)
        text += sample_head(first_frame_ + static_cast<int>(k)) + operation.samples[k] + ",\n";
      text += fmt::format("{}}}\n", indent);
    } else {
      text += fmt::format("{}{} {} = {}\n", indent, operation.type, operation.name,
                          operation.samples[0]);
    }
    order += fmt::format("{}\"{}\"", order.empty() ? "" : ", ", operation.name);
  }
  return text + fmt::format("{}uniform token[] xformOpOrder = [{}]\n", indent, order);
}

std::string UsdaSurface::subsets(
    const std::function<std::string(const std::string&)>& material_path) const {
  UsdaNames names;
  std::string text;
  for (const auto& [faces, family] :
       {std::pair(&mesh_->materials, "materialBind"), std::pair(&mesh_->groups, "groups")}) {
    if (faces->names.empty()) continue;
    text += fmt::format("{}uniform token subsetFamily:{}:familyType = \"nonOverlapping\"\n", indent,
                        family);
  }
  const auto add = [&](const FaceNames& faces, const char* family, bool is_material) {
    const std::vector<std::vector<int>> members = faces_of_names(faces);
    for (std::size_t k = 0; k < faces.names.size(); ++k) {
      const std::string name = names.take(faces.names[k]);
      text += fmt::format("\n{}def GeomSubset \"{}\" (\n", indent, name);
      if (name != faces.names[k])
        text += fmt::format("{}    displayName = {}\n", indent, usda_string(faces.names[k]));
      if (is_material)
        text += fmt::format("{}    prepend apiSchemas = [\"MaterialBindingAPI\"]\n", indent);
      text += fmt::format(
          "{0})\n{0}{{\n{0}    uniform token elementType = \"face\"\n"
          "{0}    uniform token familyName = \"{1}\"\n{0}    int[] indices = ",
          indent, family);
      append_integers(members[k], text);
      text += '\n';
      if (is_material) {
        text += fmt::format("{}    rel material:binding = <{}>\n", indent,
                            material_path(faces.names[k]));
      }
      text += fmt::format("{}}}\n", indent);
    }
  };
  add(mesh_->materials, "materialBind", true);
  add(mesh_->groups, "groups", false);
  return text;
}

Result<void> UsdaSurface::write(const std::string& name,
                                const std::function<std::string(const std::string&)>& material_path,
                                AtomicFile& file) {
  if (auto written = file.write(head(name) + topology()); !written) return written;
  const std::string rest = fmt::format("{}point3f[] points = {}\n", indent, rest_);
  if (auto written = file.write(rest); !written) return written;
  if (auto written = append_samples("point3f[] points", points_, file); !written) return written;
  const std::string normals =
      fmt::format("{0}normal3f[] normals (\n{0}    interpolation = \"{1}\"\n{0})\n", indent,
                  mesh_->corner_normals.empty() ? "vertex" : "faceVarying");
  if (auto written = file.write(normals); !written) return written;
  if (auto written = append_samples("normal3f[] normals", normals_, file); !written) return written;
  if (velocities_.size() > 0) {
    if (auto written = append_samples("vector3f[] velocities", velocities_, file); !written)
      return written;
  }
  return file.write(uvs() + placement() + subsets(material_path) + "    }\n");
}

}  // namespace pliant
