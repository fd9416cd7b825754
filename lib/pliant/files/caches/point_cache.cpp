#include "pliant/files/caches/point_cache.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "pliant/core/byte_order.hpp"
#include "pliant/core/expects.hpp"
#include "pliant/files/open_file.hpp"

namespace pliant {
namespace {

class CacheFile final : public CacheBytes {
 public:
  explicit CacheFile(OpenFile file) : file_(std::move(file)) {}

  std::uint64_t size() const override { return file_.size(); }

  Result<void> read(std::uint64_t offset, void* to, std::size_t count) const override {
    auto* bytes = static_cast<char*>(to);
    while (count > 0) {
      const ssize_t got = pread(file_.descriptor(), bytes, count, static_cast<off_t>(offset));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0)
        return fail(ErrorCode::Unreadable,
                    fmt::format("cannot read the file: {}",
                                got < 0 ? std::strerror(errno) : "it has become shorter"),
                    file_.name());
      bytes += got;
      offset += static_cast<std::uint64_t>(got);
      count -= static_cast<std::size_t>(got);
    }
    return {};
  }

 private:
  OpenFile file_;
};

class CacheInMemory final : public CacheBytes {
 public:
  explicit CacheInMemory(std::string bytes) : bytes_(std::move(bytes)) {}

  std::uint64_t size() const override { return bytes_.size(); }

  Result<void> read(std::uint64_t offset, void* to, std::size_t count) const override {
    if (offset > bytes_.size() || count > bytes_.size() - offset)
      return fail(ErrorCode::Unreadable, "cannot read the file: it is too short");
    std::memcpy(to, bytes_.data() + offset, count);
    return {};
  }

 private:
  std::string bytes_;
};

// Some vertices' numbers in the file as rows of the field.
template <class Number>
void put_rows(std::span<const char> bytes, std::endian order, Eigen::Index first, Field& field) {
  const auto count = static_cast<Eigen::Index>(bytes.size() / (3 * sizeof(Number)));
  const char* from = bytes.data();
  for (Eigen::Index row = first; row < first + count; ++row) {
    for (int component = 0; component < 3; ++component, from += sizeof(Number))
      field(row, component) = number_from<Number>(from, order);
  }
}

// A time in frames that the file has in single precision, where `size` is the largest of the
// numbers that it is made of.
double whole_if_near(double time, double size) {
  const double whole = std::round(time);
  return std::abs(time - whole) <= 0x1p-22 * size ? whole : time;
}

}  // namespace

PointCache::PointCache(std::string file, std::shared_ptr<const CacheBytes> bytes,
                       CacheLayout layout)
    : file_(std::move(file)), bytes_(std::move(bytes)), layout_(std::move(layout)) {}

Result<PointCache> PointCache::open(const std::filesystem::path& file,
                                    const std::filesystem::path& root) {
  auto opened = OpenFile::open(file, root);
  if (!opened) return fail(opened.error());
  auto bytes = std::make_shared<const CacheFile>(*std::move(opened));
  auto layout = read_layout(*bytes, file);
  if (!layout) return fail(layout.error());
  return PointCache(file.string(), std::move(bytes), *std::move(layout));
}

Result<PointCache> PointCache::of_bytes(std::string bytes, const std::filesystem::path& file) {
  auto held = std::make_shared<CacheInMemory>(std::move(bytes));
  auto layout = read_layout(*held, file);
  if (!layout) return fail(layout.error());
  return PointCache(file.string(), std::move(held), *std::move(layout));
}

Result<PointCache> PointCache::of_samples(ShapeSamples samples) {
  PLIANT_EXPECTS(!samples.is_empty());
  const Eigen::Index vertices = samples[0].rows();
  for (std::size_t k = 0; k < samples.count(); ++k) {
    const Eigen::Index own = samples[k].rows();
    if (own == 0) return invalid(fmt::format("sample {} has no vertices", k));
    if (own != vertices)
      return invalid(
          fmt::format("sample {} has {} vertices, but sample 0 has {}", k, own, vertices));
  }
  PointCache cache({}, nullptr,
                   {.vertex_count = static_cast<int>(vertices),
                    .sample_count = static_cast<int>(samples.count())});
  cache.samples_ = std::move(samples);
  return cache;
}

Result<std::vector<double>> PointCache::frames(std::optional<double> first, int start,
                                               double fps) const {
  std::vector<double> frames(static_cast<std::size_t>(sample_count()));
  const bool has_own = layout_.clock == CacheLayout::Clock::Frames;
  const double begin = first.value_or(has_own ? layout_.start : start);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    double since = static_cast<double>(k), size = 0;
    if (layout_.clock == CacheLayout::Clock::Frames) {
      since *= layout_.step;
      size = since;
    } else if (layout_.clock == CacheLayout::Clock::Seconds) {
      const double from = layout_.seconds.front(), to = layout_.seconds[k];
      since = (to - from) * fps;
      size = std::max(std::abs(from), std::abs(to)) * fps;
    }
    frames[k] = begin + whole_if_near(since, size);
    const auto refuse = [&](std::string_view rule) {
      return fail(ErrorCode::InvalidInput,
                  fmt::format("sample {} is at frame {}, but {}", k, frames[k], rule), file_);
    };
    if (!std::isfinite(frames[k])) return refuse("must be at a finite one");
    if (k > 0 && !(frames[k] > frames[k - 1]))
      return refuse(fmt::format("must be after sample {}, which is at {}", k - 1, frames[k - 1]));
  }
  return frames;
}

Result<Field> PointCache::read(int sample, Field reuse) const {
  PLIANT_EXPECTS(sample >= 0 && sample < sample_count());
  if (!bytes_) {
    reuse = samples_[static_cast<std::size_t>(sample)];
    return reuse;
  }
  constexpr Eigen::Index most_rows = 4096;
  const std::size_t row_bytes = 3 * layout_.number_size();
  alignas(8) std::array<char, 3 * sizeof(double) * most_rows> room;
  reuse.resize(vertex_count(), 3);
  std::uint64_t offset =
      layout_.begin + layout_.sample_bytes() * static_cast<std::uint64_t>(sample);
  for (Eigen::Index row = 0; row < reuse.rows(); row += most_rows) {
    const Eigen::Index rows = std::min(most_rows, reuse.rows() - row);
    const std::span<char> bytes(room.data(), row_bytes * static_cast<std::size_t>(rows));
    if (auto read = bytes_->read(offset, bytes.data(), bytes.size()); !read)
      return fail(read.error());
    if (layout_.is_double) {
      put_rows<double>(bytes, layout_.byte_order, row, reuse);
    } else {
      put_rows<float>(bytes, layout_.byte_order, row, reuse);
    }
    offset += bytes.size();
  }
  return reuse;
}

}  // namespace pliant
