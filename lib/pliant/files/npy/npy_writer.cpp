#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/core/byte_order.hpp"
#include "pliant/core/expects.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/files/formats.hpp"
#include "pliant/files/row_order.hpp"

namespace pliant {
namespace {

// Magic, version, length of the header, then a Python literal padded with spaces so that the
// numbers start at a multiple of 64 bytes.
std::string npy_header(int frames, int vertices) {
  std::string literal = fmt::format(
      "{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, {}, 3), }}", frames, vertices);
  constexpr std::size_t prefix = 10;
  const std::size_t unpadded = prefix + literal.size() + 1;
  literal.append((64 - unpadded % 64) % 64, ' ').push_back('\n');
  std::string header("\x93NUMPY\x01\x00", 8);
  append_number(header, static_cast<std::uint16_t>(literal.size()));
  return header + literal;
}

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
  const std::string header = npy_header(plan.frame_count(), plan.mesh->vertex_count());
  if (auto written = file->write(header); !written) return fail(written.error());
  return std::make_unique<NpyWriter>(*std::move(file), plan.should_stop);
}

}  // namespace pliant
