#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/files/byte_sink.hpp"
#include "pliant/files/formats.hpp"
#include "pliant/files/single_precision.hpp"
#include "pliant/files/spool_file.hpp"
#include "pliant/files/usd/usda_names.hpp"
#include "pliant/files/writer.hpp"
#include "pliant/files/written_mesh.hpp"
#include "pliant/mesh/normals.hpp"

namespace pliant {
namespace {

std::string layer_head(const AnimationPlan& plan) {
  return fmt::format(
      "#usda 1.0\n(\n    defaultPrim = \"scene\"\n    doc = \"pliant\"\n    endTimeCode = {}\n"
      "    framesPerSecond = {}\n    metersPerUnit = 1\n    startTimeCode = {}\n"
      "    timeCodesPerSecond = {}\n    upAxis = \"Y\"\n)\n\ndef Xform \"scene\" (\n"
      "    kind = \"component\"\n)\n{{\n",
      plan.last_frame, plan.fps, plan.first_frame, plan.fps);
}

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

// One surface or collider of a USD file: collects the samples of each attribute until they can be
// written.
class UsdaSurface {
 public:
  // Errors: Unwritable; Interrupted.
  static Result<UsdaSurface> make(const AnimationPlan& plan, const AnimatedSurface& surface,
                                  WrittenAs as);

  // Errors: Unwritable; NotFinite; Interrupted.
  Result<void> add(const SurfacePose& pose, int frame);

  // Writes the prim with the given name. `material_path` returns the path of a material's prim by
  // its name; null: of that of colliders. Errors: Unwritable; Interrupted.
  Result<void> write(const std::string& name,
                     const std::function<std::string(const std::string*)>& material_path,
                     AtomicFile& file);

  const Mesh& mesh() const { return *mesh_; }
  const std::string& name() const { return name_; }

 private:
  // The samples of one part of a placement, as text.
  struct Operation {
    std::string type, name;
    std::vector<std::string> samples = {};
  };

  UsdaSurface(const AnimationPlan& plan, const AnimatedSurface& surface, WrittenAs as,
              SpoolFile points, SpoolFile normals, SpoolFile velocities);

  Result<void> add_pose(const Field& positions, int frame);
  Result<void> add_sample(SpoolFile& samples, int frame, std::span<const float> numbers);
  Result<void> add_velocities(int frame, const Field& way);
  void add_placement(const Placement& placement);
  std::string head(const std::string& name) const;
  Result<void> add_topology(TextPieces& out) const;
  Result<void> add_uvs(TextPieces& out) const;
  std::string samples_of(const Operation& operation) const;
  std::string placement() const;
  Result<void> add_subsets(const std::function<std::string(const std::string*)>& material_path,
                           TextPieces& out) const;

  std::string name_;
  WrittenMesh written_;
  const Mesh* mesh_;
  int first_frame_;
  int last_frame_;
  double fps_;
  WrittenAs as_;
  StopRequest should_stop_;
  std::string rest_;     // points at rest
  std::string extents_;  // samples
  SpoolFile points_, normals_, velocities_;
  std::optional<Field> last_;     // positions of the last frame
  bool is_last_written_ = false;  // of a collider
  std::vector<Operation> operations_;
  Operation visibility_ = {"token", "visibility"};  // of a collider
};

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

// The materials named by faces, and that of colliders, as prims that a program can shade.
class MaterialScope {
 public:
  explicit MaterialScope(std::string scope) : scope_(std::move(scope)) {}

  // Null: that of colliders.
  std::string path_of(const std::string* name) {
    Material material{name ? *name : "collider", {}, name == nullptr};
    const auto [place, is_new] =
        numbers_.try_emplace({material.is_of_colliders, material.name}, materials_.size());
    if (is_new) {
      material.prim = names_.take(material.name);
      materials_.push_back(std::move(material));
    }
    return path(materials_[place->second].prim);
  }

  std::string text() const {
    if (materials_.empty()) return {};
    std::string text = fmt::format("\n    def Scope \"{}\"\n    {{\n", scope_);
    for (const auto& [name, prim, is_of_colliders] : materials_) {
      text += fmt::format("        def Material \"{}\"", prim);
      if (prim != name)
        text += fmt::format(" (\n            displayName = {}\n        )", usda_string(name));
      text += fmt::format(
          "\n        {{\n            token outputs:surface.connect = "
          "<{0}/surface.outputs:surface>\n\n            def Shader \"surface\"\n            {{\n"
          "                uniform token info:id = \"UsdPreviewSurface\"\n{1}"
          "                float inputs:roughness = 0.7\n"
          "                token outputs:surface\n            }}\n        }}\n",
          path(prim),
          is_of_colliders
              ? fmt::format("                color3f inputs:diffuseColor = ({0}, {0}, {0})\n",
                            collider_grey)
              : "");
    }
    return text + "    }\n";
  }

 private:
  struct Material {
    std::string name, prim;
    bool is_of_colliders;
  };

  std::string path(const std::string& prim) const { return "/scene/" + scope_ + '/' + prim; }

  std::string scope_;
  UsdaNames names_;
  std::vector<Material> materials_;
  std::map<std::pair<bool, std::string>, std::size_t> numbers_;  // of the colliders', by its name
};

class UsdaWriter final : public AnimationWriter {
 public:
  UsdaWriter(AtomicFile file, std::vector<UsdaSurface> things, std::size_t surface_count)
      : file_(std::move(file)), things_(std::move(things)), surface_count_(surface_count) {}

  Result<void> write(int frame, std::span<const SurfacePose> surfaces,
                     std::span<const SurfacePose> colliders) override {
    PLIANT_EXPECTS(surfaces.size() == surface_count_ &&
                   surfaces.size() + colliders.size() == things_.size());
    for (std::size_t k = 0; k < things_.size(); ++k) {
      const SurfacePose& pose = k < surface_count_ ? surfaces[k] : colliders[k - surface_count_];
      if (auto added = things_[k].add(pose, frame); !added) return added;
    }
    return {};
  }

  Result<void> finish() override {
    UsdaNames names;
    std::vector<std::string> prims;
    for (const UsdaSurface& thing : things_) prims.push_back(names.take(thing.name()));
    MaterialScope materials(names.take("materials"));
    for (std::size_t k = 0; k < things_.size(); ++k) {
      auto written = things_[k].write(
          prims[k], [&](const std::string* name) { return materials.path_of(name); }, file_);
      if (!written) return written;
    }
    if (auto written = file_.write(materials.text() + "}\n"); !written) return written;
    return file_.commit();
  }

 private:
  AtomicFile file_;
  std::vector<UsdaSurface> things_;  // surfaces, then colliders
  std::size_t surface_count_;
};

}  // namespace

Result<std::unique_ptr<AnimationWriter>> make_usda_writer(const AnimationPlan& plan) {
  auto file = AtomicFile::create(plan.file);
  if (!file) return fail(file.error());
  if (auto written = file->write(layer_head(plan)); !written) return fail(written.error());
  std::vector<UsdaSurface> things;
  const auto add = [&](const AnimatedSurface& surface, WrittenAs as) -> Result<void> {
    auto made = UsdaSurface::make(plan, surface, as);
    if (!made) return fail(made.error());
    things.push_back(*std::move(made));
    return {};
  };
  for (const AnimatedSurface& surface : plan.surfaces) {
    auto added = add(surface, plan.is_placed ? WrittenAs::PlacedSurface : WrittenAs::Surface);
    if (!added) return fail(added.error());
  }
  for (const AnimatedSurface& collider : plan.colliders) {
    if (auto added = add(collider, WrittenAs::Collider); !added) return fail(added.error());
  }
  return std::make_unique<UsdaWriter>(*std::move(file), std::move(things), plan.surfaces.size());
}

}  // namespace pliant
