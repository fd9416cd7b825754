#include "pliant/sampling/animated_shape.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/sampling/memory.hpp"
#include "pliant/sampling/rest_shape.hpp"
#include "pliant/scene/checks/check.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {
namespace {

// Samples, frames of vertices and frames of nodes that are kept, of each.
constexpr std::size_t most_kept = 4;

// Vertices of one node of a grid may be apart by this share of the sample's diagonal, as at the
// seam of a closed grid.
constexpr double one_node = 1e-6;

// The lowest vertex of each node. A net or a refined cage is not asked for.
std::vector<int> lowest_vertex_of_nodes(const std::vector<int>& vertex_nodes,
                                        Eigen::Index node_count) {
  std::vector<int> lowest(static_cast<std::size_t>(node_count), -1);
  for (std::size_t vertex = vertex_nodes.size(); vertex-- > 0;) {
    if (vertex_nodes[vertex] >= 0) lowest[vertex_nodes[vertex]] = static_cast<int>(vertex);
  }
  PLIANT_EXPECTS(std::ranges::none_of(lowest, [](int vertex) { return vertex < 0; }));
  return lowest;
}

bool counts_up(const std::vector<int>& numbers) {
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    if (numbers[k] != static_cast<int>(k)) return false;
  }
  return true;
}

double diagonal_of(const Field& positions) {
  return length_of(positions.colwise().maxCoeff() - positions.colwise().minCoeff());
}

}  // namespace

std::shared_ptr<const Field> AnimatedShape::FieldCache::find(int number) {
  const auto found = std::ranges::find(entries_, number, &Entry::number);
  if (found == entries_.end()) return nullptr;
  std::rotate(entries_.begin(), found, found + 1);
  return entries_.front().field;
}

void AnimatedShape::FieldCache::keep(int number, Shared field) {
  if (entries_.size() == most_kept) entries_.pop_back();
  entries_.insert(entries_.begin(), {number, std::move(field)});
}

AnimatedShape::AnimatedShape(PointCache cache, std::vector<double> frames, const RestShape& shape,
                             std::optional<ShapeCycle> cycle)
    : cache_(std::move(cache)),
      frames_(std::move(frames)),
      first_index_(shape.mesh.first_index),
      lowest_(lowest_vertex_of_nodes(shape.cache_nodes(), shape.rest.rows())),
      at_rest_(std::make_shared<const Field>(shape.rest)),
      cycle_(cycle) {
  PLIANT_EXPECTS(frames_.size() == static_cast<std::size_t>(cache_.sample_count()));
  if (shape.grid) nodes_ = shape.cache_nodes();
  is_same_ =
      counts_up(lowest_) && lowest_.size() == static_cast<std::size_t>(cache_.vertex_count());
}

Result<void> AnimatedShape::check_sample(int number, const Field& positions) const {
  const auto refuse = [&](const std::string& message) {
    return fail(ErrorCode::InvalidInput,
                fmt::format("{}sample {}, at frame {}: {}",
                            cache_.file().empty() ? "" : fmt::format("cache {}, ", cache_.file()),
                            number, frames_[static_cast<std::size_t>(number)], message));
  };
  for (Eigen::Index row = 0; row < positions.rows(); ++row) {
    const auto at = positions.row(row);
    if (at.allFinite()) continue;
    return refuse(fmt::format("vertex {} is at ({}, {}, {}), but must be finite",
                              row + first_index_, at[0], at[1], at[2]));
  }
  if (nodes_.empty() || is_same_) return {};
  const double most = one_node * diagonal_of(positions);
  for (std::size_t vertex = 0; vertex < nodes_.size(); ++vertex) {
    const int lowest = nodes_[vertex] >= 0 ? lowest_[nodes_[vertex]] : static_cast<int>(vertex);
    const double apart =
        length_of(positions.row(static_cast<Eigen::Index>(vertex)) - positions.row(lowest));
    if (apart <= most) continue;
    return refuse(fmt::format("vertices {} and {} are one node of the grid, but {} apart",
                              lowest + first_index_, static_cast<int>(vertex) + first_index_,
                              apart));
  }
  return {};
}

int AnimatedShape::frame_of_cycle(int frame) const {
  if (!cycle_) return frame;
  const int way = (frame - cycle_->start) % cycle_->length;
  return cycle_->start + (way < 0 ? way + cycle_->length : way);
}

Result<std::shared_ptr<const Field>> AnimatedShape::sample(int number) const {
  if (Shared kept = samples_.find(number)) return kept;
  auto positions = cache_.read(number);
  if (!positions) return fail(positions.error());
  if (auto sound = check_sample(number, *positions); !sound) return fail(sound.error());
  auto shared = std::make_shared<const Field>(*std::move(positions));
  samples_.keep(number, shared);
  return shared;
}

Result<std::shared_ptr<const Field>> AnimatedShape::vertices(int frame) const {
  frame = frame_of_cycle(frame);
  const double time = frame;
  const auto next = std::ranges::upper_bound(frames_, time);
  const int after = static_cast<int>(next - frames_.begin());
  // Held outside, and exact at a sample.
  if (after == 0) return sample(0);
  const double from = frames_[static_cast<std::size_t>(after) - 1];
  if (next == frames_.end() || time == from) return sample(after - 1);
  if (Shared kept = vertices_.find(frame)) return kept;
  auto a = sample(after - 1);
  if (!a) return a;
  auto b = sample(after);
  if (!b) return b;
  const double share = (time - from) / (*next - from);
  auto between = std::make_shared<const Field>(**a + share * (**b - **a));
  vertices_.keep(frame, between);
  return between;
}

Result<std::shared_ptr<const Field>> AnimatedShape::nodes(int frame) const {
  if (is_same_) return vertices(frame);
  frame = frame_of_cycle(frame);
  if (Shared kept = node_shapes_.find(frame)) return kept;
  auto all = vertices(frame);
  if (!all) return all;
  Field of_nodes(static_cast<Eigen::Index>(lowest_.size()), 3);
  for (std::size_t node = 0; node < lowest_.size(); ++node) {
    of_nodes.row(static_cast<Eigen::Index>(node)) = (*all)->row(lowest_[node]);
  }
  auto shared = std::make_shared<const Field>(std::move(of_nodes));
  node_shapes_.keep(frame, shared);
  return shared;
}

Result<std::shared_ptr<const Field>> AnimatedShape::vertices_at(int frame) const {
  const std::lock_guard lock(mutex_);
  return vertices(frame);
}

Result<std::shared_ptr<const Field>> AnimatedShape::nodes_at(int frame) const {
  const std::lock_guard lock(mutex_);
  return nodes(frame);
}

Result<ShapeFrames> AnimatedShape::frames_around(int frame) const {
  const std::lock_guard lock(mutex_);
  ShapeFrames shape;
  for (const int step : {-1, 0, 1}) {
    auto at = nodes(frame + step);
    if (!at) return fail(at.error());
    (step < 0 ? shape.before : step == 0 ? shape.now : shape.after) = *std::move(at);
  }
  const bool is_within = first_frame() <= frame && frame <= last_frame();
  if (!is_within || cycle_) return shape;
  const auto mirrored = [&](const Field& other) {
    return std::make_shared<const Field>(2 * *shape.now - other);
  };
  if (frame - 1 < first_frame()) {
    shape.before = mirrored(*shape.after);
  } else if (frame + 1 > last_frame()) {
    shape.after = mirrored(*shape.before);
  }
  return shape;
}

Result<void> AnimatedShape::check(int first, int last, const RunContext& context) const {
  if (cycle_) std::tie(first, last) = std::pair(cycle_->start, cycle_->start + cycle_->length - 1);
  // From the sample at or before the first frame to the one at or after the last.
  const auto begin = std::ranges::upper_bound(frames_, double(first)) - frames_.begin();
  const auto end = std::ranges::lower_bound(frames_, double(last)) - frames_.begin();
  const auto most = std::ssize(frames_) - 1;
  for (auto number = std::max<std::ptrdiff_t>(begin - 1, 0); number <= std::min(end, most);
       ++number) {
    if (context.is_stopped()) return interrupted();
    const std::lock_guard lock(mutex_);
    if (auto read = sample(static_cast<int>(number)); !read) return fail(read.error());
  }
  return {};
}

std::size_t AnimatedShape::bytes(std::size_t vertex_count, int sample_count) {
  constexpr std::size_t row = 3 * sizeof(double);
  // Those that are kept, and two neighbours and a mirrored one while they are used.
  const std::size_t fields = std::size_t{3} * most_kept + 3;
  return fields * row * vertex_count + static_cast<std::size_t>(sample_count) * 3 * sizeof(double);
}

Result<void> animate(RestShape& shape, MemoryShare& memory, const CacheUse& use, const Scene& scene,
                     const RunContext& context) {
  const auto located = [&](Error error) {
    if (error.code == ErrorCode::Unreadable)
      return fail(
          scene.origin.located({.code = error.code, .message = unreadable_mesh(error, use.title)},
                               scene.origin.at(use.name, "cache")));
    if (error.code == ErrorCode::Interrupted) return fail(std::move(error));
    const std::string part = error.file.empty() ? "" : fmt::format("cache {}: ", error.file);
    error.message = fmt::format("{}: {}{}", use.title, part, error.message);
    return fail(scene.origin.located(std::move(error), scene.origin.at(use.name, "cache")));
  };
  auto cache = use.cache.samples.is_empty() ? PointCache::open(use.cache.path, scene.origin.root)
                                            : PointCache::of_samples(use.cache.samples);
  if (!cache) return located(cache.error());
  const auto vertices = std::ssize(shape.cache_nodes());
  if (cache->vertex_count() != vertices) {
    return located({.message = fmt::format("{} has {} vertices, but the shape has {}",
                                           cache->file().empty() ? "its cache" : "it",
                                           cache->vertex_count(), vertices),
                    .file = use.cache.path});
  }
  const std::size_t bytes =
      memory.bytes() + use.bytes + cache->bytes() +
      AnimatedShape::bytes(static_cast<std::size_t>(vertices), cache->sample_count());
  if (!memory.try_resize(bytes)) {
    return located({.code = ErrorCode::OutOfMemory,
                    .message = "its animated shape " + memory.complaint(bytes)});
  }
  auto frames = cache->frames(use.cache.first, scene.start, scene.fps);
  if (!frames) return located(frames.error());
  auto animation = std::make_shared<const AnimatedShape>(*std::move(cache), *std::move(frames),
                                                         shape, use.cycle);
  if (auto sound = animation->check(use.used.first, use.used.last, context); !sound)
    return located(sound.error());
  shape.animation = std::move(animation);
  return {};
}

Result<void> animate(ReservedShape& made, const Surface& surface, const Scene& scene,
                     const RunContext& context) {
  PLIANT_EXPECTS(surface.is_animated());
  const FrameSpan used = sampled_frames(scene, surface);
  CacheUse use{.title = fmt::format("surface \"{}\"", surface.name),
               .name = surface.name,
               .cache = surface.cache,
               .used = {used.first - 1, used.last + 1}};
  if (surface.solver.loop)
    use.cycle = ShapeCycle{first_solved_frame(scene, surface), *surface.solver.loop};
  // A step on triangles places a copy of them.
  if (made.shape.surface) use.bytes = bytes_as_surface(made.shape.mesh);
  return animate(made.shape, made.memory, use, scene, context);
}

}  // namespace pliant
