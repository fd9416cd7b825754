#include "pliant/files/usd/usda_surface.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "pliant/files/single_precision.hpp"
#include "pliant/files/usd/usda_names.hpp"
#include "pliant/mesh/normals.hpp"

namespace pliant {
namespace {

constexpr const char* indent = "        ";

void append_vector(float x, float y, float z, std::string& text) {
  fmt::format_to(std::back_inserter(text), "({}, {}, {})", x, y, z);
}

// Writes rows of three as [(x, y, z), …].
Result<void> add_vectors(std::span<const float> numbers, TextPieces& out) {
  out.text += '[';
  for (std::size_t k = 0; k < numbers.size(); k += 3) {
    if (k > 0) out.text += ", ";
    append_vector(numbers[k], numbers[k + 1], numbers[k + 2], out.text);
    if (auto passed = out.pass_on(); !passed) return passed;
  }
  out.text += ']';
  return {};
}

Result<void> add_integers(std::span<const int> numbers, TextPieces& out) {
  auto end = std::back_inserter(out.text);
  out.text += '[';
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    fmt::format_to(end, "{}{}", k > 0 ? ", " : "", numbers[k]);
    if (auto passed = out.pass_on(); !passed) return passed;
  }
  out.text += ']';
  return {};
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

Result<void> append_samples(std::string_view attribute, SpoolFile& samples, AtomicFile& file,
                            const StopRequest& should_stop) {
  const std::string head = fmt::format("{}{}.timeSamples = {{\n", indent, attribute);
  if (auto written = file.write(head); !written) return written;
  if (auto copied = samples.copy_to(file, should_stop); !copied) return copied;
  return file.write(fmt::format("{}}}\n", indent));
}

// One axis after the other, as in xformOp:rotateXYZ: x first.
std::string rotate_operation(RotateOrder order) {
  std::string name = "xformOp:rotate";
  for (const int axis : axes(order)) name += static_cast<char>('X' + axis);
  return name;
}

}  // namespace

UsdaSurface::UsdaSurface(const AnimationPlan& plan, const AnimatedSurface& surface, WrittenAs as,
                         SpoolFile points, SpoolFile normals, SpoolFile velocities)
    : name_(surface.name),
      written_(*surface.mesh),
      mesh_(&written_.in_space(surface.is_mirrored)),
      first_frame_(plan.first_frame),
      last_frame_(plan.last_frame),
      fps_(plan.fps),
      as_(as),
      should_stop_(plan.should_stop),
      points_(std::move(points)),
      normals_(std::move(normals)),
      velocities_(std::move(velocities)) {}

Result<UsdaSurface> UsdaSurface::make(const AnimationPlan& plan, const AnimatedSurface& surface,
                                      WrittenAs as) {
  auto points = SpoolFile::create(plan.file);
  if (!points) return fail(points.error());
  auto normals = SpoolFile::create(plan.file);
  if (!normals) return fail(normals.error());
  auto velocities = SpoolFile::create(plan.file);
  if (!velocities) return fail(velocities.error());
  UsdaSurface made(plan, surface, as, *std::move(points), *std::move(normals),
                   *std::move(velocities));
  const auto rest = to_single(surface.rest, plan.first_frame, surface.mesh->first_index);
  if (!rest) return fail(rest.error());
  const ByteSink keep = [&](std::string_view bytes) -> Result<void> {
    made.rest_ += bytes;
    return {};
  };
  TextPieces out(keep, plan.should_stop);
  auto added = add_vectors(*rest, out);
  if (added) added = out.finish();
  if (!added) return fail(added.error());
  return made;
}

Result<void> UsdaSurface::add_sample(SpoolFile& samples, int frame,
                                     std::span<const float> numbers) {
  const ByteSink write = [&](std::string_view bytes) { return samples.write(bytes); };
  TextPieces out(write, should_stop_);
  out.text = sample_head(frame);
  if (auto added = add_vectors(numbers, out); !added) return added;
  out.text += ",\n";
  return out.finish();
}

Result<void> UsdaSurface::add(const SurfacePose& pose, int frame) {
  if (as_ != WrittenAs::Surface) {
    auto held =
        check_placement(pose.placement, PlacementNumbers::Double, told_as(as_, name_), frame);
    if (!held) return held;
    add_placement(pose.placement);
  }
  if (as_ != WrittenAs::Collider) {
    if (auto added = add_pose(pose.positions, frame); !added) return added;
    if (last_) {
      const Field way = pose.positions - *last_;
      if (auto added = add_velocities(frame - 1, way); !added) return added;
      if (frame == last_frame_) {
        if (auto added = add_velocities(frame, way); !added) return added;
      }
    }
    last_ = pose.positions;
    return {};
  }
  // Only where they change: in between and before and after values are held.
  visibility_.samples.emplace_back(pose.is_shown ? "\"inherited\"" : "\"invisible\"");
  const bool changes = !last_ || !are_equal(*last_, pose.positions);
  if (changes && last_ && !is_last_written_) {
    if (auto added = add_pose(*last_, frame - 1); !added) return added;
  }
  if (changes) {
    if (auto added = add_pose(pose.positions, frame); !added) return added;
  }
  last_ = pose.positions;
  is_last_written_ = changes;
  return {};
}

Result<void> UsdaSurface::add_pose(const Field& positions, int frame) {
  const auto numbers = to_single(positions, frame, mesh_->first_index);
  if (!numbers) return fail(numbers.error());
  if (auto added = add_sample(points_, frame, *numbers); !added) return added;

  extents_ += sample_head(frame);
  append_extent(*numbers, extents_);
  extents_ += ",\n";

  auto normals = unit_normals(*mesh_, positions, should_stop_);
  if (!normals) return fail(normals.error());
  StopPoll poll(should_stop_);
  Field rows;  // one per corner if not one per vertex
  if (!mesh_->corner_normals.empty()) {
    rows.resize(static_cast<Eigen::Index>(mesh_->corner_normals.size()), 3);
    for (Eigen::Index k = 0; k < rows.rows(); ++k) {
      if (poll.after(4)) return interrupted();
      rows.row(k) = normals->row(mesh_->corner_normals[static_cast<std::size_t>(k)]);
    }
  }
  const auto directions = to_single(mesh_->corner_normals.empty() ? *normals : rows, frame);
  if (!directions) return fail(directions.error());
  return add_sample(normals_, frame, *directions);
}

Result<void> UsdaSurface::add_velocities(int frame, const Field& way) {
  const auto numbers = to_single(way * fps_, frame);
  if (!numbers) return fail(numbers.error());
  return add_sample(velocities_, frame, *numbers);
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
  if (as_ == WrittenAs::Collider || !mesh_->materials.names.empty())
    text += fmt::format("{}prepend apiSchemas = [\"MaterialBindingAPI\"]\n", indent);
  text += "    )\n    {\n";
  return text +
         fmt::format("{0}uniform bool doubleSided = 1\n{0}float3[] extent.timeSamples = {{\n",
                     indent) +
         extents_ + indent + "}\n";
}

Result<void> UsdaSurface::add_topology(TextPieces& out) const {
  out.text += fmt::format("{}int[] faceVertexCounts = ", indent);
  if (auto added = add_integers(mesh_->face_sizes, out); !added) return added;
  out.text += fmt::format("\n{}int[] faceVertexIndices = ", indent);
  if (auto added = add_integers(mesh_->corner_vertices, out); !added) return added;
  out.text += fmt::format(
      "\n{0}uniform token orientation = \"rightHanded\"\n"
      "{0}uniform token subdivisionScheme = \"none\"\n",
      indent);
  return {};
}

Result<void> UsdaSurface::add_uvs(TextPieces& out) const {
  if (std::all_of(mesh_->corner_uvs.begin(), mesh_->corner_uvs.end(),
                  [](int uv) { return uv < 0; })) {
    return {};
  }
  // A corner without (u,v) gets (0,0) if others have them.
  std::vector<int> indices = mesh_->corner_uvs;
  const auto origin = static_cast<int>(mesh_->uvs.size());
  const bool has_gaps = std::find(indices.begin(), indices.end(), -1) != indices.end();
  std::replace(indices.begin(), indices.end(), -1, origin);
  out.text += fmt::format("{}texCoord2f[] primvars:st = [", indent);
  for (std::size_t k = 0; k < mesh_->uvs.size(); ++k) {
    if (auto passed = out.pass_on(); !passed) return passed;
    fmt::format_to(std::back_inserter(out.text), "{}({}, {})", k > 0 ? ", " : "",
                   static_cast<float>(mesh_->uvs[k][0]), static_cast<float>(mesh_->uvs[k][1]));
  }
  if (has_gaps) out.text += ", (0, 0)";
  out.text += fmt::format("] (\n{0}    interpolation = \"faceVarying\"\n{0})\n", indent);
  out.text += fmt::format("{}int[] primvars:st:indices = ", indent);
  if (auto added = add_integers(indices, out); !added) return added;
  out.text += '\n';
  return {};
}

std::string UsdaSurface::samples_of(const Operation& operation) const {
  const bool is_moving =
      std::any_of(operation.samples.begin(), operation.samples.end(),
                  [&](const std::string& sample) { return sample != operation.samples[0]; });
  if (!is_moving) {
    return fmt::format("{}{} {} = {}\n", indent, operation.type, operation.name,
                       operation.samples[0]);
  }
  std::string text =
      fmt::format("{}{} {}.timeSamples = {{\n", indent, operation.type, operation.name);
  for (std::size_t k = 0; k < operation.samples.size(); ++k)
    text += sample_head(first_frame_ + static_cast<int>(k)) + operation.samples[k] + ",\n";
  return text + fmt::format("{}}}\n", indent);
}

std::string UsdaSurface::placement() const {
  if (operations_.empty()) return {};
  std::string text, order;
  for (const Operation& operation : operations_) {
    text += samples_of(operation);
    order += fmt::format("{}\"{}\"", order.empty() ? "" : ", ", operation.name);
  }
  return text + fmt::format("{}uniform token[] xformOpOrder = [{}]\n", indent, order);
}

Result<void> UsdaSurface::add_subsets(
    const std::function<std::string(const std::string*)>& material_path, TextPieces& out) const {
  UsdaNames names;
  std::string& text = out.text;
  for (const auto& [faces, family] :
       {std::pair(&mesh_->materials, "materialBind"), std::pair(&mesh_->groups, "groups")}) {
    if (faces->names.empty()) continue;
    text += fmt::format("{}uniform token subsetFamily:{}:familyType = \"nonOverlapping\"\n", indent,
                        family);
  }
  const auto add = [&](const FaceNames& faces, const char* family,
                       bool is_material) -> Result<void> {
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
      if (auto added = add_integers(members[k], out); !added) return added;
      text += '\n';
      if (is_material) {
        text += fmt::format("{}    rel material:binding = <{}>\n", indent,
                            material_path(&faces.names[k]));
      }
      text += fmt::format("{}}}\n", indent);
      if (auto passed = out.pass_on(); !passed) return passed;
    }
    return {};
  };
  if (auto added = add(mesh_->materials, "materialBind", true); !added) return added;
  return add(mesh_->groups, "groups", false);
}

Result<void> UsdaSurface::write(const std::string& name,
                                const std::function<std::string(const std::string*)>& material_path,
                                AtomicFile& file) {
  const ByteSink write = [&](std::string_view bytes) { return file.write(bytes); };
  TextPieces out(write, should_stop_);
  out.text = head(name);
  if (auto added = add_topology(out); !added) return added;
  out.text += fmt::format("{}point3f[] points = ", indent);
  if (auto written = out.finish(); !written) return written;
  if (auto written = write_in_pieces(rest_ + '\n', should_stop_, write); !written) return written;
  const auto add_samples = [&](std::string_view attribute, SpoolFile& samples) {
    return append_samples(attribute, samples, file, should_stop_);
  };
  if (auto written = add_samples("point3f[] points", points_); !written) return written;
  const std::string normals =
      fmt::format("{0}normal3f[] normals (\n{0}    interpolation = \"{1}\"\n{0})\n", indent,
                  mesh_->corner_normals.empty() ? "vertex" : "faceVarying");
  if (auto written = file.write(normals); !written) return written;
  if (auto written = add_samples("normal3f[] normals", normals_); !written) return written;
  if (velocities_.size() > 0) {
    if (auto written = add_samples("vector3f[] velocities", velocities_); !written) return written;
  }
  if (auto added = add_uvs(out); !added) return added;
  out.text += placement();
  if (as_ == WrittenAs::Collider) {
    out.text += samples_of(visibility_);
    out.text += fmt::format("{}rel material:binding = <{}>\n", indent, material_path(nullptr));
  } else if (auto added = add_subsets(material_path, out); !added) {
    return added;
  }
  out.text += "    }\n";
  return out.finish();
}

}  // namespace pliant
