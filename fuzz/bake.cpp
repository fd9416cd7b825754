// Arbitrary text as a scene that is baked, if it is tiny, into files that are then read again: the
// first byte says in which format, and whether surfaces are placed. A second bake reads the states
// that the first one stored.

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "pliant/core/text.hpp"
#include "pliant/files/caches/point_cache.hpp"
#include "pliant/files/obj/read_obj.hpp"
#include "pliant/files/ply/read_ply.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/files/read_mesh.hpp"
#include "tiny_scene.hpp"

using namespace pliant;
using namespace pliant::fuzzing;

namespace {

namespace fs = std::filesystem;

constexpr std::array endings = {".obj", ".ply", ".npy", ".pc2", ".mdd", ".glb", ".gltf", ".usda"};
constexpr int frames_baked = 4;

/// A folder that is empty for each input, in memory where the system has one.
class OutputFolder {
 public:
  OutputFolder() {
    const fs::path memory = "/dev/shm";
    const fs::path parent = fs::is_directory(memory) ? memory : fs::temp_directory_path();
    std::string pattern = parent / "pliant-fuzz-XXXXXX";
    require(mkdtemp(pattern.data()) != nullptr);
    path_ = pattern;
  }
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder() { fs::remove_all(path_); }

  fs::path file(std::string_view name) const { return path_ / name; }

  std::vector<fs::path> files() const {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(path_)) files.push_back(entry.path());
    return files;
  }

 private:
  fs::path path_;
};

std::string bytes_of(const fs::path& file) {
  auto bytes = read_file(file);
  require(bytes.has_value());
  return *std::move(bytes);
}

void check_mesh_file(const Result<Mesh>& mesh) {
  require(mesh.has_value() && check_mesh(*mesh).has_value() && mesh->positions.allFinite());
}

void check_cache_file(const fs::path& file) {
  const auto cache = PointCache::open(file);
  require(cache.has_value());
  for (int sample = 0; sample < cache->sample_count(); ++sample) {
    const auto positions = cache->read(sample);
    require(positions && positions->allFinite());
  }
}

/// A glTF has one node for each surface.
void check_gltf_file(const fs::path& file, const Simulation& simulation) {
  for (const RestShape& shape : simulation.rest_shapes())
    check_mesh_file(read_mesh(file, shape.name));
}

void check_usda_file(const std::string& text) {
  require(text.starts_with("#usda 1.0"));
  for (const std::string_view number : {"(nan", "(inf", "(-inf", ", nan", ", inf", ", -inf"})
    require(text.find(number) == std::string::npos);
}

void check_file(const fs::path& file, const Simulation& simulation) {
  require(!file.filename().string().starts_with('.'));  // nothing half written
  const std::string ending = ending_of(file);
  if (ending == ".obj") check_mesh_file(read_obj(file));
  if (ending == ".ply") check_mesh_file(read_ply(file));
  if (ending == ".npy" || ending == ".pc2" || ending == ".mdd") check_cache_file(file);
  if (ending == ".glb" || ending == ".gltf") check_gltf_file(file, simulation);
  if (ending == ".usda") check_usda_file(bytes_of(file));
}

Placement placement_at(const TransformChannels& transform, int frame) {
  const auto vector = [&](const Channel<3>& channel) {
    const Value<3> value = channel.at(frame);
    return Vector3d(value[0], value[1], value[2]);
  };
  return {vector(transform.translate), vector(transform.rotate), vector(transform.scale),
          transform.rotate_order};
}

AnimationPlan plan_of(const Simulation& simulation, const std::string& file, bool is_placed) {
  const Scene& scene = simulation.scene();
  AnimationPlan plan{.file = file,
                     .first_frame = scene.start,
                     .last_frame = std::min(scene.end, scene.start + frames_baked - 1),
                     .fps = scene.fps,
                     .is_placed = is_placed};
  for (std::size_t k = 0; k < simulation.rest_shapes().size(); ++k) {
    const RestShape& shape = simulation.rest_shapes()[k];
    Field rest = shape.mesh.positions;
    Transform transform;
    if (!is_placed) {
      transform = make_transform(placement_at(scene.surfaces[k].transform, scene.start));
      rest = to_world(transform, rest);
    }
    plan.surfaces.push_back({.name = shape.name,
                             .mesh = &shape.mesh,
                             .rest = std::move(rest),
                             .is_mirrored = transform.is_mirrored()});
  }
  return plan;
}

std::vector<SurfacePose> poses_of(const Frame& frame, const Scene& scene, bool is_placed) {
  std::vector<SurfacePose> poses;
  for (std::size_t k = 0; k < frame.surfaces().size(); ++k) {
    const SurfaceFrame& surface = frame.surfaces()[k];
    SurfacePose& pose = poses.emplace_back();
    require(surface.object_positions().allFinite());
    pose.positions = is_placed ? surface.object_positions() : surface.positions();
    pose.is_mirrored = !is_placed && surface.transform().is_mirrored();
    if (is_placed) pose.placement = placement_at(scene.surfaces[k].transform, frame.number());
  }
  return poses;
}

/// The positions of the surfaces at each frame that could be computed.
using Positions = std::vector<std::vector<Field>>;

/// Whether all frames were written.
bool write_frames(Simulation& simulation, const AnimationPlan& plan, AnimationWriter& writer,
                  Positions& positions) {
  for (int number = plan.first_frame; number <= plan.last_frame; ++number) {
    const auto frame = simulation.at(number);
    if (!frame) return check_error(frame.error()), false;
    const auto poses = poses_of(*frame, simulation.scene(), plan.is_placed);
    positions.emplace_back();
    for (const SurfaceFrame& surface : frame->surfaces())
      positions.back().push_back(surface.object_positions());
    if (const auto written = writer.write(number, poses); !written)
      return check_error(written.error()), false;
  }
  const auto finished = writer.finish();
  if (!finished) check_error(finished.error());
  return finished.has_value();
}

void bake(Simulation& simulation, const AnimationPlan& plan, const OutputFolder& folder,
          Positions& positions) {
  bool is_whole = false;
  {
    const auto writer = make_writer(plan);
    if (!writer) return check_error(writer.error());
    is_whole = write_frames(simulation, plan, **writer, positions);
  }
  const auto files = folder.files();
  require(!is_whole || !files.empty());
  for (const fs::path& file : files) check_file(file, simulation);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size == 0) return 0;
  const std::string ending = endings[bytes[0] % endings.size()];
  const bool takes_placements = ending == ".glb" || ending == ".gltf" || ending == ".usda";
  const bool is_placed = takes_placements && (bytes[0] & 8) != 0;
  auto scene = parse_scene(text_of(bytes + 1, size - 1), "fuzz.xml", PLIANT_FUZZ_MESHES);
  if (!scene || scene->surfaces.empty() || !is_tiny(*scene) || !is_short(*scene)) return 0;

  MemoryStateStore store(std::size_t{10} << 20);
  int steps = 0;
  SimulationOptions options = bounded(steps);
  options.store = &store;
  auto first = Simulation::make(*scene, options);
  if (!first) return check_error(first.error(), any_number), 0;
  const OutputFolder folder;
  const AnimationPlan plan = plan_of(*first, folder.file("out" + ending), is_placed);
  Positions positions;
  bake(*first, plan, folder, positions);

  steps = 0;
  auto second = Simulation::make(*std::move(scene), options);
  require(second.has_value());
  for (std::size_t k = 0; k < positions.size(); ++k) {
    const auto frame = second->at(plan.first_frame + static_cast<int>(k));
    require(frame.has_value());
    for (std::size_t n = 0; n < positions[k].size(); ++n)
      require(frame->surfaces()[n].object_positions() == positions[k][n]);
  }
  return 0;
}
