#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pliant/core/byte_order.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/files/formats.hpp"
#include "pliant/files/obj/obj_text.hpp"
#include "pliant/files/row_order.hpp"
#include "pliant/files/single_precision.hpp"
#include "pliant/files/written_mesh.hpp"

namespace pliant {
namespace {

// Reverses the bytes of each number. Not as floats: some of the results are signalling NaNs.
void swap_bytes(std::span<float> numbers) {
  for (float& number : numbers) {
    const std::span<char> bytes(reinterpret_cast<char*>(&number), sizeof(number));
    std::reverse(bytes.begin(), bytes.end());
  }
}

template <std::endian order>
class PointCacheWriter final : public SurfaceWriter {
 public:
  PointCacheWriter(AtomicFile cache, AtomicFile mesh, const SurfacePlan& plan)
      : cache_(std::move(cache)),
        mesh_(std::move(mesh)),
        first_index_(plan.mesh->first_index),
        should_stop_(plan.should_stop) {}

  Result<void> write(int frame, const SurfacePose& pose) override {
    const Field& positions = pose.positions;
    numbers_.resize(3 * static_cast<std::size_t>(std::min(rows_at_a_time, positions.rows())));
    return for_row_blocks(positions, [&](Eigen::Index first, Eigen::Index count) -> Result<void> {
      if (is_stopped(should_stop_)) return interrupted();
      const std::span<float> numbers(numbers_.data(), 3 * static_cast<std::size_t>(count));
      if (auto rounded = to_single(positions, frame, first, numbers, first_index_); !rounded)
        return rounded;
      if (order != std::endian::native) swap_bytes(numbers);
      return cache_.write(std::span<const float>(numbers));
    });
  }

  Result<void> finish() override {
    if (auto committed = mesh_.commit(); !committed) return committed;
    return cache_.commit();
  }

 private:
  AtomicFile cache_;
  AtomicFile mesh_;
  int first_index_;  // first vertex number in messages
  StopRequest should_stop_;
  std::vector<float> numbers_;  // some rows
};

Result<AtomicFile> write_mesh(const SurfacePlan& plan) {
  auto file = AtomicFile::create(std::filesystem::path(plan.file).replace_extension(".obj"));
  if (!file) return file;
  WrittenMesh mesh(*plan.mesh);
  const auto text = ObjText::make(mesh.in_space(plan.is_mirrored), plan.should_stop);
  if (!text) return fail(text.error());
  const auto written = text->write(
      plan.rest ? *plan.rest : plan.mesh->positions,
      [&](std::string_view bytes) { return file->write(bytes); }, plan.should_stop);
  if (!written) return fail(written.error());
  return file;
}

template <std::endian order>
Result<std::unique_ptr<SurfaceWriter>> make_writer(const SurfacePlan& plan,
                                                   const std::string& header) {
  auto cache = AtomicFile::create(plan.file);
  if (!cache) return fail(cache.error());
  if (auto written = cache->write(header); !written) return fail(written.error());
  auto mesh = write_mesh(plan);
  if (!mesh) return fail(mesh.error());
  return std::make_unique<PointCacheWriter<order>>(*std::move(cache), *std::move(mesh), plan);
}

}  // namespace

Result<std::unique_ptr<SurfaceWriter>> make_pc2_writer(const SurfacePlan& plan) {
  constexpr std::endian order = std::endian::little;
  std::string header("POINTCACHE2\0", 12);
  append_number(header, std::int32_t{1}, order);
  append_number(header, std::int32_t{plan.mesh->vertex_count()}, order);
  append_number(header, static_cast<float>(plan.first_frame), order);
  append_number(header, 1.0f, order);
  append_number(header, std::int32_t{plan.frame_count()}, order);
  return make_writer<order>(plan, header);
}

Result<std::unique_ptr<SurfaceWriter>> make_mdd_writer(const SurfacePlan& plan) {
  if (auto last = to_single_seconds(plan.frame_count(), plan.fps); !last) return fail(last.error());
  constexpr std::endian order = std::endian::big;
  std::string header;
  append_number(header, std::int32_t{plan.frame_count()}, order);
  append_number(header, std::int32_t{plan.mesh->vertex_count()}, order);
  for (int k = 0; k < plan.frame_count(); ++k)
    append_number(header, static_cast<float>(k / plan.fps), order);
  return make_writer<order>(plan, header);
}

}  // namespace pliant
