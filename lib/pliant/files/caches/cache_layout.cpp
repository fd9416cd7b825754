#include "pliant/files/caches/cache_layout.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/byte_order.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/npy/npy_header.hpp"

namespace pliant {
namespace {

constexpr std::uint64_t most_count = std::numeric_limits<int>::max();

class LayoutReader {
 public:
  LayoutReader(const CacheBytes& bytes, const std::filesystem::path& file)
      : bytes_(bytes), file_(file.string()), ending_(ending_of(file)) {}

  Result<CacheLayout> read() {
    Result<CacheLayout> layout =
        refuse("the name of a cache must end in .pc2, .mdd or .npy: the formats that are read");
    if (ending_ == ".pc2") layout = read_pc2();
    if (ending_ == ".mdd") layout = read_mdd();
    if (ending_ == ".npy") layout = read_npy();
    if (!layout) return layout;
    return checked(*std::move(layout));
  }

 private:
  tl::unexpected<Error> refuse(std::string message) const {
    return fail(ErrorCode::InvalidInput, std::move(message), file_);
  }

  // The first bytes of the file. Errors: it has fewer.
  Result<std::string> head(std::size_t count) const {
    if (bytes_.size() < count)
      return refuse(fmt::format("the file has {} bytes, but the head of a {} has {}", bytes_.size(),
                                ending_, count));
    std::string text(count, '\0');
    if (auto read = bytes_.read(0, text.data(), count); !read) return fail(read.error());
    return text;
  }

  Result<void> set_counts(std::uint64_t samples, std::uint64_t vertices,
                          CacheLayout& layout) const {
    if (samples < 1 || samples > most_count)
      return refuse(fmt::format("it has {} samples, but must have 1 to {}", samples, most_count));
    if (vertices < 1 || vertices > most_count)
      return refuse(fmt::format("it has {} vertices, but must have 1 to {}", vertices, most_count));
    layout.sample_count = static_cast<int>(samples);
    layout.vertex_count = static_cast<int>(vertices);
    return {};
  }

  // A signed number, of which less than 0 is none.
  static std::uint64_t count_at(const std::string& head, std::size_t place, std::endian order) {
    return static_cast<std::uint64_t>(
        std::max(number_from<std::int32_t>(head.data() + place, order), 0));
  }

  Result<CacheLayout> read_pc2() const {
    constexpr std::string_view magic("POINTCACHE2\0", 12);
    constexpr std::size_t size = 32;
    const auto text = head(size);
    if (!text) return fail(text.error());
    if (std::string_view(*text).substr(0, magic.size()) != magic)
      return refuse("it is no .pc2: it does not begin with POINTCACHE2");
    const auto version = number_from<std::int32_t>(text->data() + 12);
    if (version != 1)
      return refuse(fmt::format("its version is {}, but only version 1 is read", version));
    CacheLayout layout{.clock = CacheLayout::Clock::Frames, .begin = size};
    constexpr std::endian order = std::endian::little;
    if (auto set = set_counts(count_at(*text, 28, order), count_at(*text, 16, order), layout); !set)
      return fail(set.error());
    layout.start = number_from<float>(text->data() + 20);
    layout.step = number_from<float>(text->data() + 24);
    if (!std::isfinite(layout.start))
      return refuse(fmt::format("its start frame is {}, but must be finite", layout.start));
    if (!(std::isfinite(layout.step) && layout.step > 0))
      return refuse(
          fmt::format("its sample rate is {} frames, but must be finite and greater than "
                      "0",
                      layout.step));
    return layout;
  }

  Result<CacheLayout> read_mdd() const {
    const auto text = head(8);
    if (!text) return fail(text.error());
    constexpr std::endian order = std::endian::big;
    CacheLayout layout{.clock = CacheLayout::Clock::Seconds, .byte_order = order};
    if (auto set = set_counts(count_at(*text, 0, order), count_at(*text, 4, order), layout); !set)
      return fail(set.error());
    // The counts are checked before any memory is taken for the times.
    const auto samples = static_cast<std::uint64_t>(layout.sample_count);
    layout.begin = 8 + 4 * samples;
    if (auto whole = check_size(layout); !whole) return fail(whole.error());
    std::string times(static_cast<std::size_t>(4 * samples), '\0');
    if (auto read = bytes_.read(8, times.data(), times.size()); !read) return fail(read.error());
    layout.seconds.resize(static_cast<std::size_t>(samples));
    for (std::size_t k = 0; k < layout.seconds.size(); ++k) {
      layout.seconds[k] = number_from<float>(times.data() + 4 * k, order);
    }
    return layout;
  }

  Result<CacheLayout> read_npy() const {
    const auto first =
        head(static_cast<std::size_t>(std::min<std::uint64_t>(bytes_.size(), longest_npy_head)));
    if (!first) return fail(first.error());
    auto header = read_npy_header(*first, bytes_.size());
    if (!header) return refuse(header.error().message);
    CacheLayout layout{
        .begin = header->begin, .is_double = header->is_double, .byte_order = header->byte_order};
    const std::vector<std::uint64_t>& shape = header->shape;
    if (shape.size() != 3 || shape[2] != 3)
      return refuse(
          fmt::format("its shape is {}, but must be (samples, vertices, 3)", header->shape_text));
    if (auto set = set_counts(shape[0], shape[1], layout); !set) return fail(set.error());
    return layout;
  }

  // Whether all numbers that the counts promise are there, and can be kept track of: a sparse file
  // has many without taking room.
  Result<void> check_size(const CacheLayout& layout) const {
    // 3 · 8 · 2^31 fits; times 2^31 it may not.
    const std::uint64_t held = bytes_.size() > layout.begin ? bytes_.size() - layout.begin : 0;
    const std::uint64_t whole = held / layout.sample_bytes();
    const auto promised = static_cast<std::uint64_t>(layout.sample_count);
    if (whole < promised)
      return refuse(
          fmt::format("it is truncated: it promises {} samples of {} vertices, but has {} "
                      "whole ones",
                      promised, layout.vertex_count, whole));
    constexpr std::uint64_t most_samples = 10'000'000;
    if (promised <= most_samples) return {};
    return refuse(
        fmt::format("it has {} samples, but at most {} are read", promised, most_samples));
  }

  Result<CacheLayout> checked(CacheLayout layout) const {
    if (auto whole = check_size(layout); !whole) return fail(whole.error());
    return layout;
  }

  const CacheBytes& bytes_;
  std::string file_;
  std::string ending_;
};

}  // namespace

Result<CacheLayout> read_layout(const CacheBytes& bytes, const std::filesystem::path& file) {
  return LayoutReader(bytes, file).read();
}

}  // namespace pliant
