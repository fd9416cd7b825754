#include "pliant/document/save_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "pliant/core/text.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/files/caches/point_cache.hpp"
#include "pliant/files/npy/npy_header.hpp"
#include "pliant/files/open_file.hpp"
#include "pliant/files/opened_mesh.hpp"
#include "pliant/files/row_order.hpp"
#include "pliant/files/write_mesh.hpp"
#include "pliant/scene/checks/check.hpp"
#include "pliant/scene/format/description.hpp"
#include "pliant/scene/inputs.hpp"
#include "pliant/scene/write.hpp"

namespace pliant {
namespace {

// Where the values of a map or a hold come from.
struct ValueSource {
  std::string name;  // `density`, `hold.0`
  std::string* file;
  std::string* attribute;
  std::vector<double>* values;
};

std::vector<ValueSource> sources_of(Surface& surface) {
  std::vector<ValueSource> sources;
  for (MaterialMap& map : surface.maps)
    sources.push_back({std::string(map_channel_words[static_cast<std::size_t>(map.channel)]),
                       &map.file, &map.attribute, &map.values});
  for (std::size_t k = 0; k < surface.holds.size(); ++k) {
    Hold& hold = surface.holds[k];
    sources.push_back({name_of_hold(k), &hold.file, &hold.attribute, &hold.values});
  }
  return sources;
}

// Writes what a scene has in memory to files without names, and puts their names into a copy of the
// scene. All get their names at the end.
class SceneSaver {
 public:
  SceneSaver(const Scene& scene, const std::string& file, const StopRequest& should_stop)
      : scene_(scene), file_(file), should_stop_(should_stop) {}

  Result<void> save() {
    if (const auto errors = check_scene(scene_, should_stop_); !errors.empty())
      return fail(errors.front());
    for (Surface& surface : scene_.surfaces) {
      if (auto moved = move_out(surface); !moved) return moved;
    }
    for (Collider& collider : scene_.colliders) {
      auto* const closed = std::get_if<ClosedMesh>(&collider.shape);
      if (!closed) continue;
      if (auto moved = move_out(collider.name, *closed); !moved) return moved;
    }
    const auto text = to_xml(scene_, folder_of_file(file_.string()), should_stop_);
    if (!text) return fail(text.error());
    if (auto checked = check_inputs(); !checked) return checked;
    auto own = AtomicFile::create(file_);
    if (!own) return fail(own.error());
    if (auto written = own->write(*text, should_stop_); !written) return written;
    files_.push_back(*std::move(own));
    if (is_stopped(should_stop_)) return interrupted();
    return commit_all(std::move(files_));
  }

 private:
  Result<void> move_out(Surface& surface) {
    if (surface.is_driven()) {  // it has none in a file
      surface.maps.clear();
      surface.holds.clear();
    }
    std::vector<ValueSource> sources = sources_of(surface);
    std::erase_if(sources, [](const ValueSource& source) { return source.values->empty(); });
    Result<void> moved;
    if (const auto* const sheet = std::get_if<GridSheet>(&surface.shape)) {
      moved = move_out(surface.name, sources, sheet->columns, sheet->rows);
    } else if (const auto* const net = std::get_if<NurbsNet>(&surface.shape)) {
      moved = move_out(surface.name, sources, net->u.count, net->v.count);
    } else {
      moved = move_out_mesh(surface, sources);
    }
    if (!moved) return moved;
    return move_out(surface.name, surface.cache);
  }

  // Values at the nodes of a grid.
  Result<void> move_out(const std::string& name, std::span<const ValueSource> sources, int columns,
                        int rows) {
    for (const ValueSource& source : sources) {
      const std::vector<double>& values = *source.values;
      const auto nodes = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
      if (values.size() != nodes)
        return invalid(fmt::format("{}.{} has {} values, but the surface has {} nodes", name,
                                   source.name, values.size(), nodes));
      for (std::size_t k = 0; k < nodes; ++k) {
        if (!std::isfinite(values[k]))
          return invalid(fmt::format("{}.{}: value {} is {}, which is not finite", name,
                                     source.name, k, values[k]));
      }
      *source.file = path_of(name, source.name + ".npy");
      auto written = add(
          *source.file,
          npy_head(std::array{static_cast<std::size_t>(rows), static_cast<std::size_t>(columns)}),
          [&](AtomicFile& to) { return to.write(std::span<const double>(values)); });
      if (!written) return written;
      moved_paths_.push_back(source.file);
      source.values->clear();
    }
    return {};
  }

  Result<void> move_out_mesh(Surface& surface, std::span<const ValueSource> sources) {
    if (auto* const file = std::get_if<MeshFile>(&surface.shape)) {
      if (sources.empty()) return {};
      auto mesh = read(*file, surface);
      if (!mesh) return fail(mesh.error());
      surface.shape = *std::move(mesh);
    }
    Mesh& mesh = std::get<Mesh>(surface.shape);
    for (const auto& [part, file, attribute, values] : sources) {
      *attribute = free_name(mesh, part);
      mesh.attributes.push_back({*attribute, std::move(*values)});
      values->clear();
    }
    if (std::ranges::all_of(sources_of(surface),
                            [](const ValueSource& source) { return source.attribute->empty(); }))
      mesh.attributes.clear();  // nothing reads them
    auto path = write(surface.name, fmt::format("surface \"{}\"", surface.name), mesh);
    if (!path) return fail(path.error());
    surface.shape = MeshFile{.path = *std::move(path)};
    moved_paths_.push_back(&std::get<MeshFile>(surface.shape).path);
    return {};
  }

  Result<void> move_out(const std::string& name, ClosedMesh& closed) {
    if (closed.made) {
      closed.made->attributes.clear();  // nothing reads them
      auto path = write(name, fmt::format("collider \"{}\"", name), *closed.made);
      if (!path) return fail(path.error());
      closed.made.reset();
      closed.mesh.path = *std::move(path);
      moved_paths_.push_back(&closed.mesh.path);
    }
    return move_out(name, closed.cache);
  }

  Result<void> move_out(const std::string& name, ShapeCache& cache) {
    if (cache.samples.is_empty()) return {};
    const ShapeSamples samples = std::exchange(cache.samples, {});
    if (const auto checked = PointCache::of_samples(samples); !checked) {
      Error error = checked.error();
      error.message = fmt::format("{}.cache: {}", name, error.message);
      return fail(std::move(error));
    }
    cache.path = path_of(name, "cache.npy");
    moved_paths_.push_back(&cache.path);
    const std::array<std::size_t, 3> shape = {samples.count(),
                                              static_cast<std::size_t>(samples[0].rows()), 3};
    std::vector<double> numbers;
    return add(cache.path, npy_head(shape), [&](AtomicFile& to) -> Result<void> {
      for (std::size_t k = 0; k < samples.count(); ++k) {
        auto written =
            for_row_blocks(samples[k], [&](Eigen::Index first, Eigen::Index count) -> Result<void> {
              if (is_stopped(should_stop_)) return interrupted();
              numbers.resize(3 * static_cast<std::size_t>(count));
              to_row_order(samples[k], first, std::span<double>(numbers));
              return to.write(std::span<const double>(numbers));
            });
        if (!written) return written;
      }
      return {};
    });
  }

  // A mesh in a file, with all attributes that its surface reads.
  Result<Mesh> read(const MeshFile& file, Surface& surface) const {
    std::vector<std::string> names;
    for (const ValueSource& source : sources_of(surface)) {
      const std::string& name = *source.attribute;
      if (!name.empty() && std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
    const auto opened = OpenFile::open(file.path, scene_.origin.root);
    if (!opened) return fail(opened.error());
    RunContext context;
    context.should_stop = should_stop_;
    return read_mesh(*opened, file.object, file.uv_set, file.root, context, names);
  }

  // A name for an attribute that the mesh does not have.
  static std::string free_name(const Mesh& mesh, const std::string& part) {
    std::string name = part;
    for (int number = 2;
         std::ranges::find(mesh.attributes, name, &VertexAttribute::name) != mesh.attributes.end();
         ++number)
      name = fmt::format("{}_{}", part, number);
    return name;
  }

  // Writes a mesh in the first format that keeps it. Returns the file's name.
  Result<std::string> write(const std::string& name, const std::string& title, const Mesh& mesh) {
    std::string file = path_of(name, mesh.attributes.empty() ? "obj" : "ply");
    auto bytes = mesh_bytes(mesh, file, should_stop_);
    if (!bytes && bytes.error().code == ErrorCode::InvalidInput && mesh.attributes.empty()) {
      const std::string other = path_of(name, "ply");
      if (auto others = mesh_bytes(mesh, other, should_stop_); others) {
        file = other;
        bytes = std::move(others);
      }
    }
    if (!bytes) {
      Error error = bytes.error();
      if (error.code != ErrorCode::Interrupted)
        error.message = fmt::format("{}: {}", title, error.message);
      return fail(std::move(error));
    }
    auto written = add(file, *bytes, [](AtomicFile&) { return Result<void>(); });
    if (!written) return fail(written.error());
    return file;
  }

  std::string path_of(const std::string& name, std::string_view part) const {
    return (file_.parent_path() / fmt::format("{}.{}.{}", file_.stem().string(), name, part))
        .string();
  }

  // Adds a file: its first bytes, then those that `write` writes.
  template <class Write>
  Result<void> add(const std::string& name, std::string_view head, const Write& write) {
    auto file = AtomicFile::create(name);
    if (!file) return fail(file.error());
    if (auto written = file->write(head, should_stop_); !written) return written;
    if (auto written = write(*file); !written) return written;
    files_.push_back(*std::move(file));
    names_.push_back(name);
    return {};
  }

  // Whether no file that is replaced is one that the scene still reads. What was moved out is not
  // in the scene after this.
  Result<void> check_inputs() {
    if (names_.empty()) return {};
    for (std::string* const path : moved_paths_) path->clear();
    for (const SceneInput& input : inputs_of(scene_, should_stop_)) {
      for (const std::string& name : names_) {
        std::error_code unknown;
        if (!std::filesystem::equivalent(input.file, name, unknown) &&
            input.file.lexically_normal() != std::filesystem::path(name).lexically_normal())
          continue;
        return fail(ErrorCode::InvalidInput,
                    fmt::format("the file cannot be written beside the scene, because it is {}",
                                input.role),
                    name);
      }
    }
    return {};
  }

  Scene scene_;
  std::filesystem::path file_;
  const StopRequest& should_stop_;
  std::vector<AtomicFile> files_;          // those beside the scene
  std::vector<std::string> names_;         // theirs
  std::vector<std::string*> moved_paths_;  // their places in the scene
};

}  // namespace

Result<void> save_scene(const Scene& scene, const std::string& file,
                        const StopRequest& should_stop) {
  return SceneSaver(scene, file, should_stop).save();
}

}  // namespace pliant
