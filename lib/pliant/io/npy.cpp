#include "pliant/io/npy.hpp"

#include <utility>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/io/atomic_file.hpp"

namespace pliant {
namespace {

// Magic, version, length of the header, then a Python literal padded with blanks so that the
// numbers start at a multiple of 64 bytes.
std::string npy_header(int frames, int vertices) {
  std::string literal = fmt::format(
      "{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, {}, 3), }}", frames, vertices);
  constexpr std::size_t prefix = 10;
  const std::size_t unpadded = prefix + literal.size() + 1;
  literal.append((64 - unpadded % 64) % 64, ' ').push_back('\n');
  std::string header("\x93NUMPY\x01\x00", 8);
  header.push_back(static_cast<char>(literal.size() & 0xff));
  header.push_back(static_cast<char>(literal.size() >> 8));
  return header + literal;
}

class NpyWriter final : public SurfaceWriter {
 public:
  explicit NpyWriter(AtomicFile file) : file_(std::move(file)) {}

  Result<void> write(int, const Field& positions) override {
    rows_ = positions;
    return file_.write({rows_.data(), static_cast<std::size_t>(rows_.size())});
  }

  Result<void> finish() override { return file_.commit(); }

 private:
  AtomicFile file_;
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> rows_;  // the file's order, kept
};

}  // namespace

Result<std::unique_ptr<SurfaceWriter>> make_npy_writer(const SurfacePlan& plan) {
  auto file = AtomicFile::create(plan.file);
  if (!file) return fail(file.error());
  const std::string header = npy_header(plan.frame_count(), plan.mesh->vertex_count());
  if (auto written = file->write(header); !written) return fail(written.error());
  return std::make_unique<NpyWriter>(*std::move(file));
}

}  // namespace pliant
