#include "editor/new_object.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "pliant/core/shortened.hpp"
#include "pliant/core/text.hpp"
#include "pliant/document/operation.hpp"
#include "pliant/scene/format/format.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant::editor {
namespace {

constexpr double share_of_size = 0.1;  // that a new force moves a surface

// A number as a person would type it.
std::string round_text(double number, int digits = 2) {
  return number == 0 ? "0" : edit::to_text(*to_number(fmt::format("{:.{}g}", number, digits)));
}

std::string round_text(const Vector3d& vector, double size) {
  const double step = std::pow(10, std::floor(std::log10(std::max(size, 1e-12))) - 2);
  std::string text;
  for (const double number : vector) {
    const double rounded = std::round(number / step) * step;
    text += (text.empty() ? "" : " ") + round_text(rounded, 6);
  }
  return text;
}

std::set<std::string> names_of(const Scene& scene) {
  std::set<std::string> names = {"scene"};
  for (const Surface& surface : scene.surfaces) names.insert(surface.name);
  for (const Force& force : scene.forces) names.insert(force.name);
  for (const Group& group : scene.groups) names.insert(group.name);
  for (const Collider& collider : scene.colliders) names.insert(collider.name);
  return names;
}

std::string free_name(const Scene& scene, const std::string& base) {
  const std::set<std::string> names = names_of(scene);
  if (!names.contains(base)) return base;
  for (int number = 2;; ++number) {
    std::string name = base + std::to_string(number);
    if (!names.contains(name)) return name;
  }
}

// Where a surface is at the first frame, in the world.
struct Place {
  Vector3d middle = Vector3d::Zero();   // of its vertices, the one nearest to their mean
  Vector3d normal = Vector3d::UnitY();  // there
  double size = 1;                      // half the diagonal of its box
};

Place place_of(const RestShape& shape, const Surface& surface, int frame) {
  const Mesh& mesh = shape.mesh;
  const Transform transform = make_transform(surface.transform.placement_at(frame));
  const Field world =
      (mesh.positions * transform.linear.transpose()).rowwise() + transform.translation.transpose();
  const Eigen::RowVector3d mean = world.colwise().mean();
  Eigen::Index nearest = 0;
  (world.rowwise() - mean).rowwise().squaredNorm().minCoeff(&nearest);
  Place place;
  place.middle = world.row(nearest).transpose();
  place.size = 0.5 * (world.colwise().maxCoeff() - world.colwise().minCoeff()).norm();
  Vector3d normal = Vector3d::Zero();
  std::size_t first = 0;
  for (const int size : mesh.face_sizes) {
    const int* const corners = mesh.corner_vertices.data() + first;
    first += static_cast<std::size_t>(size);
    if (std::find(corners, corners + size, nearest) == corners + size) continue;
    const Vector3d a = world.row(corners[0]), b = world.row(corners[1]), c = world.row(corners[2]);
    normal += (b - a).cross(c - a);
  }
  if (normal.norm() > 0) place.normal = normal.normalized();
  return place;
}

bool has(const ElementFormat& format, std::string_view attribute) {
  return std::ranges::find(format.attributes, attribute, &AttributeFormat::name) !=
         format.attributes.end();
}

bool is_named(const ElementFormat& format) {
  const auto name = std::ranges::find(format.attributes, "name", &AttributeFormat::name);
  return name != format.attributes.end() && name->type == "name";
}

// The kinds of shape that an element may have, such as a surface.
std::vector<std::string_view> shapes_in(std::string_view element) {
  const ElementFormat* const format = find_format(scene_format(), element);
  if (format == nullptr) return {};
  for (const ChildFormat& child : format->children)
    if (child.is_choice()) return child.names;
  return {};
}

bool contains(const std::vector<std::string_view>& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

class NewObjects {
 public:
  NewObjects(const SceneDocument& document, const NewObject& wanted,
             const SimulationOptions& options)
      : document_(document), scene_(document.scene()), wanted_(wanted), options_(options) {}

  Result<Addition> make() {
    const ElementFormat* const format = find_format(scene_format(), wanted_.kind);
    if (auto found = find_place(); !found) return fail(found.error());
    if (contains(shapes_in(Description<Surface>::element), wanted_.kind)) return surface();
    if (contains(shapes_in(Description<Collider>::element), wanted_.kind)) return collider(*format);
    if (format != nullptr && is_named(*format) && contains(format->parents, "scene") &&
        wanted_.kind != Description<Surface>::element &&
        wanted_.kind != Description<Collider>::element)
      return force(*format);
    return invalid(fmt::format("no kind {} can be added", in_quotes(wanted_.kind)));
  }

 private:
  // Where the surface is at which the object is to stand.
  Result<void> find_place() {
    const auto found = std::ranges::find(scene_.surfaces, wanted_.surface, &Surface::name);
    if (!wanted_.surface.empty() && found == scene_.surfaces.end())
      return fail(ErrorCode::InvalidInput,
                  fmt::format("no surface is named {}", printable(wanted_.surface)));
    if (scene_.surfaces.empty()) return {};
    index_ = found == scene_.surfaces.end()
                 ? 0
                 : static_cast<std::size_t>(found - scene_.surfaces.begin());
    const auto simulation = Simulation::make(scene_, options_);
    if (!simulation) return fail(simulation.error());
    place_ = place_of(simulation->rest_shapes()[index_], scene_.surfaces[index_], scene_.start);
    return {};
  }

  bool has_surface() const { return !scene_.surfaces.empty(); }

  Addition added(edit::Add addition) const {
    return {addition.name, {Operation(std::move(addition))}};
  }

  // Beside those that are there.
  Result<Addition> surface() {
    edit::Add add{.kind = "surface",
                  .name = free_name(scene_, wanted_.kind == "grid" ? "sheet" : "mesh")};
    add.shape = wanted_.kind;
    const double size = has_surface() ? place_.size * std::sqrt(2) : 4;
    if (wanted_.kind == "grid") {
      add.attributes = {{"columns", "41"},
                        {"rows", "41"},
                        {"width", round_text(size)},
                        {"depth", round_text(size)}};
    } else if (wanted_.file.empty()) {
      return invalid(fmt::format("a <{}> needs a file", wanted_.kind));
    } else {
      add.name = free_name(scene_, name_like(wanted_.file));
      add.attributes = {{"file", edit::literal_text(wanted_.file)}};
      if (!wanted_.object.empty())
        add.attributes.emplace_back("object", edit::literal_text(wanted_.object));
    }
    if (has_surface() && wanted_.kind == "grid") {
      const double step = 1.25 * size * static_cast<double>(scene_.surfaces.size());
      add.attributes.emplace_back("translate",
                                  round_text(place_.middle + Vector3d(step, 0, 0), size));
    }
    return added(std::move(add));
  }

  // A name from that of a file.
  static std::string name_like(const std::string& file) {
    std::string name = std::filesystem::path(file).stem().string();
    for (char& letter : name) {
      const bool is_letter = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z');
      if (!is_letter && !(letter >= '0' && letter <= '9') && letter != '-') letter = '_';
    }
    const bool begins_well = !name.empty() && name[0] != '-' && (name[0] < '0' || name[0] > '9');
    return begins_well ? name : "mesh_" + name;
  }

  // Above the surface, a plane below it.
  Result<Addition> collider(const ElementFormat& format) {
    const double size = place_.size;
    const double radius = 0.25 * size;
    edit::Add add{.kind = "collider",
                  .name = free_name(scene_, wanted_.kind == "sphere" ? "ball" : wanted_.kind)};
    add.shape = wanted_.kind;
    if (has(format, "radius")) add.attributes.emplace_back("radius", round_text(radius));
    if (has(format, "length")) add.attributes.emplace_back("length", round_text(2 * radius));
    if (has(format, "size")) {
      const std::string side = round_text(2 * radius);
      add.attributes.emplace_back("size", fmt::format("{0} {0} {0}", side));
    }
    const bool is_plane = format.attributes.empty();
    const double height = is_plane ? -0.5 * size : 3 * radius;
    add.attributes.emplace_back("translate",
                                round_text(place_.middle + height * place_.normal, size));
    if (scene_.surfaces.size() > 1)
      add.attributes.emplace_back("targets", scene_.surfaces[index_].name);
    return added(std::move(add));
  }

  Result<Addition> force(const ElementFormat& format) {
    edit::Add add{.kind = wanted_.kind, .name = free_name(scene_, wanted_.kind)};
    add.group = wanted_.group;
    const double size = place_.size;
    const auto give = [&](const char* attribute, const std::string& value) {
      if (has(format, attribute)) add.attributes.emplace_back(attribute, value);
    };
    const Vector3d across = place_.normal.unitOrthogonal();
    give("center", round_text(place_.middle, size));
    give("from", round_text(place_.middle - 0.35 * size * across, size));
    give("to", round_text(place_.middle + 0.35 * size * across, size));
    if (wanted_.kind != "line") give("direction", round_text(place_.normal, 1));
    give("axis", round_text(place_.normal, 1));
    give("frequency", round_text(2 / size));
    const bool selects =
        !has_surface() || scene_.surfaces[index_].solver.region == SolvedRegion::Forces;
    const bool has_place = has(format, "center") || has(format, "from");
    if (has_place && wanted_.group.empty() && selects)
      give("deformationRadius", round_text(0.55 * size));
    if (has_place) give("forceRadius", round_text(0.3 * size));
    if (scene_.surfaces.size() > 1 && wanted_.group.empty())
      give("targets", scene_.surfaces[index_].name);
    if (!has(format, "magnitude") || wanted_.kind == "inertia" || !has_surface())
      return added(std::move(add));
    const auto magnitude = magnitude_of(add);
    if (!magnitude) return fail(magnitude.error());
    add.attributes.emplace_back("magnitude", *magnitude);
    return added(std::move(add));
  }

  // That with which the force alone moves the surface as far as a new one should.
  Result<std::string> magnitude_of(const edit::Add& addition) const {
    const double peak = share_of_size * 2 * place_.size;
    // What is small is proportional to the magnitude; what is large may leave the force's reach.
    auto simulation = alone(addition, "1");
    if (!simulation) return fail(simulation.error());
    const auto previews = preview_forces(*simulation, options_);
    if (!previews) return fail(previews.error());
    const auto preview = std::ranges::find_if(*previews, [&](const Preview& one) {
      return one.of == Preview::Of::Force && one.surface == index_;
    });
    const double told = preview == previews->end() ? 0
                        : preview->played          ? preview->played->peak
                                                   : preview->static_peak;
    if (!(told > 0)) return std::string("1");
    const std::string guess = round_text(peak / told);
    if (!preview->played) return guess;
    simulation = alone(addition, guess);
    if (!simulation) return fail(simulation.error());
    const MotionGoals goals{
        .surface = scene_.surfaces[index_].name, .force = addition.name, .peak = peak};
    const auto suggestion = suggest_material(*simulation, goals, options_);
    if (!suggestion && suggestion.error().code == ErrorCode::Interrupted)
      return fail(suggestion.error());
    if (!suggestion || !suggestion->peak || !suggestion->peak->is_known) return guess;
    const auto value =
        std::ranges::find(suggestion->values, addition.name + ".magnitude", &SuggestedValue::path);
    return value == suggestion->values.end() ? guess : round_text(value->after, 3);
  }

  // The scene with only this force, on only this surface.
  Result<Simulation> alone(edit::Add addition, const std::string& magnitude) const {
    addition.attributes.emplace_back("magnitude", magnitude);
    SceneDocument scratch = document_;
    if (const auto done = scratch.apply({Operation(addition)}); !done) return fail(done.error());
    Scene scene = scratch.scene();
    std::erase_if(scene.forces, [&](const Force& force) { return force.name != addition.name; });
    scene.colliders.clear();
    for (std::size_t k = 0; k < scene.surfaces.size(); ++k)
      scene.surfaces[k].enabled = scene.surfaces[k].enabled && k == index_;
    return Simulation::make(std::move(scene), options_);
  }

  const SceneDocument& document_;
  const Scene& scene_;
  const NewObject& wanted_;
  SimulationOptions options_;
  std::size_t index_ = 0;  // of the surface
  Place place_;
};

}  // namespace

Result<Addition> to_add(const SceneDocument& document, const NewObject& wanted,
                        const SimulationOptions& options) {
  return NewObjects(document, wanted, options).make();
}

}  // namespace pliant::editor
