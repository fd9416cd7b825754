// Arbitrary text as a scene, checked as by `pliant validate`; a tiny one is played for some frames.
// Its meshes and caches are those of the folder meshes/.

#include <utility>

#include "tiny_scene.hpp"

using namespace pliant;
using namespace pliant::fuzzing;

namespace {

constexpr int frames_played = 3;

// As a file it is the same scene.
void check_written(const Scene& scene) {
  const auto text = to_xml(scene);
  if (!text) return check_error(text.error(), any_number);
  const auto again = parse_scene(*text, "fuzz.xml", "");
  require(again.has_value() && to_xml(*again).value() == *text);
}

// Requires: `Simulation::check` found nothing wrong.
void play(Scene scene, const SimulationOptions& options) {
  auto made = Simulation::make(std::move(scene), options);
  if (!made) {
    require(made.error().code == ErrorCode::OutOfMemory ||
            made.error().code == ErrorCode::Interrupted);
    return check_error(made.error(), any_number);
  }
  for (const RestShape& shape : made->rest_shapes()) {
    require(check_mesh(shape.mesh).has_value());
    require(shape.rest.allFinite());
  }
  int left = frames_played;
  for (const int number : made->frames()) {
    if (left-- == 0) return;
    const auto frame = made->at(number);
    if (!frame) return check_error(frame.error());
    for (const SurfaceFrame& surface : frame->surfaces()) {
      require(surface.object_positions().allFinite());
    }
  }
  for (const Warning& warning : made->warnings()) require(!warning.message().empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const auto scene = parse_scene(text_of(bytes, size), "fuzz.xml", PLIANT_FUZZ_MESHES);
  if (!scene) {
    check_error(scene.error(), any_number);
    return 0;
  }
  for (const SceneNote& note : scene->notes) require(!note.message.empty());
  check_written(*scene);
  if (!is_short(*scene)) return 0;
  int steps = 0;
  const SimulationOptions options = bounded(steps);
  if (const auto checked = Simulation::check(*scene, options); !checked) {
    check_error(checked.error(), any_number);
  } else if (is_tiny(*scene) && !scene->surfaces.empty()) {
    play(*scene, options);
  }
  return 0;
}
