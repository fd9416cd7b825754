#include "viewer/bake.hpp"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/feedback/surface_lines.hpp"
#include "viewer/arrays.hpp"
#include "viewer/channels.hpp"
#include "viewer/colliders.hpp"
#include "viewer/forces.hpp"
#include "viewer/json.hpp"
#include "viewer/mesh_order.hpp"
#include "viewer/motion.hpp"
#include "viewer/page.hpp"
#include "viewer/shape.hpp"

namespace pliant::viewer {
namespace {

// The longest text in bytes that browsers accept in one piece.
constexpr std::size_t longest_page = 500'000'000;

// One surface during the run.
class SurfaceView {
 public:
  SurfaceView(const RestShape& shape, const Surface& surface, double fps)
      : shape_(shape),
        surface_(surface),
        fps_(fps),
        motion_(shape.mesh.positions, node_order(shape.vertex_nodes)),
        rest_motion_(shape.animation ? std::optional(motion_) : std::nullopt),
        marks_(shape) {}

  Result<void> add(const SurfaceFrame& frame, int number) {
    transforms_.push_back(to_json(frame.transform()));
    peak_displacement_ = std::max(peak_displacement_, frame.told_displacement());
    Field positions = frame.positions();
    low_ = low_.cwiseMin(positions.colwise().minCoeff().transpose());
    high_ = high_.cwiseMax(positions.colwise().maxCoeff().transpose());
    if (before_.size() > 0) {
      const double moved = (positions - before_).rowwise().norm().maxCoeff();
      constexpr double rounding = 1e-12;  // of the surface's size, as in `told_displacement`
      if (moved >= rounding * (high_ - low_).maxCoeff())
        peak_speed_ = std::max(peak_speed_, moved * fps_);
    }
    before_ = std::move(positions);
    if (rest_motion_) {
      if (auto added = rest_motion_->add(frame.object_rest(), number); !added) return added;
    }
    return motion_.add(frame.object_positions(), number);
  }

  // Vertices of the nodes that colliders push at a frame.
  void touch(const std::vector<ContactFacts>& contacts) {
    if (!contacts.empty() && node_vertices_.empty()) node_vertices_ = node_vertices(shape_);
    const std::vector<std::uint32_t> vertices = touching_vertices(contacts, node_vertices_);
    std::uint32_t before = 0;
    for (const std::uint32_t vertex : vertices) {
      touching_steps_.push_back(vertex - before);
      before = vertex;
    }
    touching_counts_.push_back(static_cast<std::uint32_t>(vertices.size()));
  }

  SurfaceMarks& marks() { return marks_; }
  double peak_displacement() const { return peak_displacement_; }

  /// Errors: Interrupted.
  Result<Json> finish(Arrays& arrays, const StopRequest& should_stop) const {
    const auto motion = motion_.pack(should_stop);
    if (!motion) return fail(motion.error());
    const auto shape = shape_json(shape_, arrays, should_stop);
    if (!shape) return fail(shape.error());
    const Mesh& mesh = shape_.mesh;
    const auto size = mesh.positions.colwise().maxCoeff() - mesh.positions.colwise().minCoeff();
    // Half a step, plus the rounding of the rest position to float.
    const double error = 0.5 * motion->step + size.maxCoeff() * 0x1p-25;
    Json json = {{"name", shape_.name},
                 {"enabled", surface_.enabled},
                 {"low", to_json(low_)},
                 {"high", to_json(high_)},
                 {"peakDisplacement", peak_displacement_},
                 {"peakSpeed", peak_speed_},
                 {"step", motion->step},
                 {"error", error},
                 {"transforms", same_or_all()},
                 {"predictors", arrays.add(motion->predictors)},
                 {"lowBytes", arrays.add(motion->low)},
                 {"highBytes", arrays.add(motion->high)},
                 {"marks", marks_.changes()}};
    json.update(*shape);
    if (rest_motion_) {
      const auto rest = rest_motion_->pack(should_stop);
      if (!rest) return fail(rest.error());
      json["restMotion"] = to_json(*rest, arrays);
    }
    if (!marks_.lines().is_empty()) json["lines"] = marks_.lines().arrays(arrays);
    if (!touching_steps_.empty()) {
      json["touching"] = {{"counts", arrays.add(touching_counts_)},
                          {"steps", arrays.add(touching_steps_)}};
    }
    return json;
  }

 private:
  Json same_or_all() const {
    const bool is_still =
        std::all_of(transforms_.begin(), transforms_.end(),
                    [&](const Json& transform) { return transform == transforms_.front(); });
    return is_still ? Json::array({transforms_.front()}) : Json(transforms_);
  }

  const RestShape& shape_;
  const Surface& surface_;
  double fps_;
  MotionPacker motion_;
  std::optional<MotionPacker> rest_motion_;  // of a shape that is animated
  std::vector<Json> transforms_;
  SurfaceMarks marks_;
  std::vector<int> node_vertices_;  // empty: nothing has touched
  // Of each frame how many vertices touch; the steps to each from the one before, or from 0.
  std::vector<std::uint32_t> touching_counts_, touching_steps_;
  double peak_displacement_ = 0;
  double peak_speed_ = 0;  // from the displacement since the frame before [length/s]
  Vector3d low_ = Vector3d::Constant(std::numeric_limits<double>::infinity());  // over all frames
  Vector3d high_ = -low_;
  Field before_;  // world
};

Result<void> check_memory(const Simulation& simulation, const FrameSpan& frames,
                          const ViewLimits& limits) {
  const std::size_t max_memory = limits.max_memory;
  const auto solids = size_of_colliders(simulation);
  if (!solids) return fail(solids.error());
  std::size_t vertex_count = solids->moving_vertices;
  for (const RestShape& shape : simulation.rest_shapes()) {
    const int motions = shape.animation ? 2 : 1;
    vertex_count += static_cast<std::size_t>(motions) * shape.mesh.vertex_count();
  }
  // In addition to the packer's memory: the packed stream and its text in the page. A dot is in two
  // arrays, of which one may have twice the room, and in the stream.
  const std::size_t of_dot = simulation.scene().colliders.empty() ? 0 : 16;
  const double bytes = static_cast<double>(solids->bytes) +
                       static_cast<double>(frames.count()) * static_cast<double>(vertex_count) *
                           static_cast<double>(MotionPacker::bytes_a_vertex + 14 + of_dot);
  const double free = static_cast<double>(max_memory) -
                      static_cast<double>(std::min(max_memory, simulation.surface_memory()));
  if (bytes <= free) return {};
  const std::size_t count = simulation.scene().colliders.size();
  const std::string colliders =
      count == 0 ? "" : fmt::format(" and {} collider{}", count, count == 1 ? "" : "s");
  return fail(
      ErrorCode::OutOfMemory,
      fmt::format(
          "a page of {} frames of {} vertices{} needs {}, more than the {} that are left; {}",
          frames.count(), vertex_count, colliders, bytes_text(static_cast<std::size_t>(bytes)),
          bytes_text(static_cast<std::size_t>(free)), limits.advice));
}

using ForceNumbers = std::map<std::string, std::size_t, std::less<>>;

// Runs every frame up to the last, and adds those in `frames` to the surfaces.
Result<void> run_frames(Simulation& simulation, const FrameSpan& frames, const ViewLimits& limits,
                        std::vector<SurfaceView>& surfaces, CourseFollower& follower,
                        const ForceNumbers& force_numbers, const std::function<void()>& advance) {
  const Scene& scene = simulation.scene();
  std::vector<const Field*> rest;
  for (const RestShape& shape : simulation.rest_shapes()) rest.push_back(&shape.mesh.positions);
  for (int number = scene.start; number <= frames.last; ++number) {
    if (limits.should_stop && limits.should_stop())
      return fail(ErrorCode::Interrupted, fmt::format("interrupted at frame {}", number));
    const auto frame = simulation.at(number);
    if (!frame) return fail(frame.error());
    if (number >= frames.first) {
      const auto report = simulation.report(number, ReportDetail::Outlines);
      if (!report) return fail(report.error());
      for (std::size_t k = 0; k < surfaces.size(); ++k) {
        if (auto added = surfaces[k].add(frame->surfaces()[k], number); !added) {
          return fail(added.error());
        }
        surfaces[k].touch(report->surfaces[k].contacts);
        surfaces[k].marks().add(number, report->surfaces[k], force_numbers);
      }
      follower.add(*frame, rest);
    }
    advance();
  }
  return {};
}

}  // namespace

Result<ViewBake> view_bake(Simulation& simulation, const FrameSpan& frames,
                           const ViewLimits& limits, const std::function<void()>& advance) {
  if (auto fits = check_memory(simulation, frames, limits); !fits) {
    return fail(fits.error());
  }
  const Scene& scene = simulation.scene();
  const auto forces = view_forces(simulation, frames, limits.should_stop);
  if (!forces) return fail(forces.error());
  ForceNumbers force_numbers;
  for (std::size_t k = 0; k < forces->size(); ++k) force_numbers[(*forces)[k]["name"]] = k;
  std::vector<SurfaceView> surfaces;
  for (std::size_t k = 0; k < scene.surfaces.size(); ++k) {
    surfaces.emplace_back(simulation.rest_shapes()[k], scene.surfaces[k], scene.fps);
  }

  CourseFollower follower;
  if (auto run = run_frames(simulation, frames, limits, surfaces, follower, force_numbers, advance);
      !run) {
    return fail(run.error());
  }
  ViewBake bake;
  bake.course = follower.course();
  Arrays arrays;
  Json shown = Json::array();
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    auto finished = surfaces[k].finish(arrays, limits.should_stop);
    if (!finished) return fail(finished.error());
    shown.push_back(*std::move(finished));
    bake.vertex_count += simulation.rest_shapes()[k].mesh.vertex_count();
    bake.peak_displacement = std::max(bake.peak_displacement, surfaces[k].peak_displacement());
  }
  bake.position_bytes = std::size_t{6} * static_cast<std::size_t>(bake.vertex_count) *
                        static_cast<std::size_t>(frames.count());
  const auto channels = view_channels(scene, frames, limits.should_stop);
  if (!channels) return fail(channels.error());
  Json head = {{"version", 1},
               {"scene", scene.origin.file},
               {"fps", scene.fps},
               {"first", frames.first},
               {"last", frames.last},
               {"sceneFrames", {scene.start, scene.end}},
               {"displaced", bake.course.displaced},
               {"surfaces", shown},
               {"forces", *forces},
               {"channels", *channels},
               {"messages", messages_of(simulation)}};
  if (!scene.colliders.empty()) {
    auto colliders = view_colliders(simulation, frames, arrays, limits.should_stop);
    if (!colliders) return fail(colliders.error());
    head["colliders"] = *std::move(colliders);
  }
  auto packed = deflated(joined(head, arrays.take()), limits.should_stop);
  if (!packed) return fail(packed.error());
  bake.packed = *std::move(packed);
  return bake;
}

Result<std::string> page_of(std::string_view page, const Scene& scene, const ViewBake& bake,
                            const ViewLimits& limits) {
  const std::string title = std::filesystem::path(scene.origin.file).filename().string();
  auto whole = page_with(page, title, bake.packed, limits.should_stop);
  if (!whole || whole->size() <= longest_page) return whole;
  return fail(ErrorCode::OutOfMemory,
              fmt::format("the page would be {}, larger than the {} that a browser can load; {}",
                          bytes_text(whole->size()), bytes_text(longest_page), limits.advice));
}

}  // namespace pliant::viewer
