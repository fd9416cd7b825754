#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "pliant/files/atomic_file.hpp"
#include "pliant/files/formats.hpp"
#include "pliant/files/npy/npy_header.hpp"
#include "pliant/files/row_order.hpp"

namespace pliant {
namespace {

class NpyWriter final : public SurfaceWriter {
 public:
  NpyWriter(AtomicFile file, StopRequest should_stop)
      : file_(std::move(file)), should_stop_(std::move(should_stop)) {}

  Result<void> write(int, const SurfacePose& pose) override {
    const Field& positions = pose.positions;
    numbers_.resize(3 * static_cast<std::size_t>(std::min(rows_at_a_time, positions.rows())));
    return for_row_blocks(positions, [&](Eigen::Index first, Eigen::Index count) -> Result<void> {
      if (is_stopped(should_stop_)) return interrupted();
      const std::span<double> numbers(numbers_.data(), 3 * static_cast<std::size_t>(count));
      to_row_order(positions, first, numbers);
      return file_.write(std::span<const double>(numbers));
    });
  }

  Result<void> finish() override { return file_.commit(); }

 private:
  AtomicFile file_;
  StopRequest should_stop_;
  std::vector<double> numbers_;  // some rows, in the file's order
};

}  // namespace

Result<std::unique_ptr<SurfaceWriter>> make_npy_writer(const SurfacePlan& plan) {
  auto file = AtomicFile::create(plan.file);
  if (!file) return fail(file.error());
  const std::array shape = {static_cast<std::size_t>(plan.frame_count()),
                            static_cast<std::size_t>(plan.mesh->vertex_count()), std::size_t{3}};
  if (auto written = file->write(npy_head(shape)); !written) return fail(written.error());
  return std::make_unique<NpyWriter>(*std::move(file), plan.should_stop);
}

}  // namespace pliant
