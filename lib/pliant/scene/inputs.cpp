#include "pliant/scene/inputs.hpp"

#include <set>
#include <system_error>
#include <utility>
#include <variant>

#include <sys/stat.h>

#include "pliant/files/open_file.hpp"
#include "pliant/files/opened_mesh.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/scene/sharing/expand.hpp"

namespace pliant {

namespace {

// Files, each once.
class Inputs {
 public:
  Inputs(const std::string& root, const StopRequest& should_stop)
      : root_(root), should_stop_(should_stop) {}

  bool add(std::filesystem::path file, std::string_view role, const std::string& root) {
    const bool is_new = seen_.insert(file).second;
    if (is_new) inputs_.push_back({std::move(file), role, root});
    return is_new;
  }

  void add_cache(const ShapeCache& cache) {
    if (!cache.path.empty()) add(cache.path, "a cache of the scene", root_);
  }

  void add_mesh(const MeshFile& mesh) {
    if (!add(mesh.path, "a mesh of the scene", root_)) return;
    const auto opened = OpenFile::open(mesh.path, root_);
    if (!opened) return;
    for (auto& file : mesh_references(*opened, mesh.root, should_stop_))
      add(std::move(file), "a file that a mesh of the scene refers to", mesh.root);
  }

  void add_shape(const Surface& surface) {
    for (const MaterialMap& map : surface.maps) {
      if (!map.file.empty()) add(map.file, "a map of the scene", root_);
    }
    for (const Hold& hold : surface.holds) {
      if (!hold.file.empty()) add(hold.file, "a map of the scene", root_);
    }
    if (const auto* const mesh = std::get_if<MeshFile>(&surface.shape)) add_mesh(*mesh);
  }

  void add_collider(const Collider& collider) {
    const auto* const closed = std::get_if<ClosedMesh>(&collider.shape);
    if (!closed) return;
    add_cache(closed->cache);
    if (!closed->made) add_mesh(closed->mesh);
  }

  std::vector<SceneInput> take() { return std::move(inputs_); }

 private:
  const std::string& root_;
  const StopRequest& should_stop_;
  std::vector<SceneInput> inputs_;
  std::set<std::filesystem::path> seen_;
};

}  // namespace

std::vector<SceneInput> inputs_of(const Scene& scene, const StopRequest& should_stop) {
  const std::string& root = scene.origin.root;
  Inputs inputs(root, should_stop);
  if (!scene.origin.file.empty()) inputs.add(scene.origin.file, "the scene", {});
  if (scene.origin.sources) {
    for (const SourceMap::Source& source : scene.origin.sources->sources()) {
      if (source.include.is_known())
        inputs.add(source.file, "a file that the scene includes", root);
    }
  }
  for (const Surface& surface : scene.surfaces) {
    if (is_stopped(should_stop)) break;
    inputs.add_cache(surface.cache);
    inputs.add_shape(surface);
  }
  for (const Collider& collider : scene.colliders) {
    if (is_stopped(should_stop)) break;
    inputs.add_collider(collider);
  }
  return inputs.take();
}

std::vector<SceneInput> inputs_of_shape(const Surface& surface, const SceneOrigin& origin,
                                        const StopRequest& should_stop) {
  Inputs inputs(origin.root, should_stop);
  inputs.add_shape(surface);
  return inputs.take();
}

std::vector<SceneInput> inputs_of_collider(const Collider& collider, const SceneOrigin& origin,
                                           const StopRequest& should_stop) {
  Inputs inputs(origin.root, should_stop);
  inputs.add_collider(collider);
  return inputs.take();
}

std::vector<std::filesystem::path> text_files_of(const std::filesystem::path& scene,
                                                 const std::filesystem::path& root,
                                                 const StopRequest& should_stop) {
  std::vector<std::filesystem::path> files = {scene};
  std::error_code ignored;
  // A pipe would be empty for the one who reads it next.
  if (!std::filesystem::is_regular_file(scene, ignored)) return files;
  auto text = read_file(scene, xml::most_expanded, should_stop);
  if (!text) return files;
  const auto sources =
      std::make_shared<SourceMap>(scene.string(), std::make_shared<SourceText>(*std::move(text)));
  xml::Findings findings(sources, should_stop);
  const auto markup = xml::scan_markup(findings);
  if (!markup) return files;
  xml::TextFiles disk = xml::files_on_disk(root, should_stop);
  std::set<std::filesystem::path> seen;
  disk.identify = [&, identify = disk.identify](const std::filesystem::path& file) {
    if (file != scene && seen.insert(file).second) files.push_back(file);
    return identify(file);
  };
  xml::expand(*markup, scene.parent_path(), disk, *sources, findings);
  return files;
}

bool name_one_file(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code ignored;
  // Absolute first: otherwise a relative path that does not exist would not be resolved at all.
  const auto place = [&](const std::filesystem::path& path) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path, ignored), ignored);
  };
  return std::filesystem::equivalent(a, b, ignored) || place(a) == place(b);
}

InputFinder::InputFinder(const Scene& scene, const StopRequest& should_stop)
    : inputs_(inputs_of(scene, should_stop)) {
  for (const SceneInput& input : inputs_) {
    struct stat status = {};
    if (stat(input.file.c_str(), &status) == 0) {
      there_.try_emplace({status.st_dev, status.st_ino}, input.file);
    } else {
      missing_.emplace(input.file.filename().string(), input.file);
    }
  }
}

// One question for each of a million frames; more only for names that an input has.
std::optional<std::filesystem::path> InputFinder::find(const std::filesystem::path& output) const {
  struct stat status = {};
  if (stat(output.c_str(), &status) == 0) {
    const auto found = there_.find({status.st_dev, status.st_ino});
    return found != there_.end() ? std::optional(found->second) : std::nullopt;
  }
  const auto [first, last] = missing_.equal_range(output.filename().string());
  for (auto each = first; each != last; ++each)
    if (name_one_file(output, each->second)) return each->second;
  return std::nullopt;
}

}  // namespace pliant
