#include "pliant/files/caches/cache_layout.hpp"

#include <cstring>

#include "pliant/files/read_file.hpp"
#include "support/caches.hpp"
#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

namespace {

// Bytes that note how many of them are read, and that claim to be as many as wanted.
class NotingBytes final : public CacheBytes {
 public:
  explicit NotingBytes(std::string bytes) : bytes_(std::move(bytes)), size_(bytes_.size()) {}
  NotingBytes(std::string bytes, std::uint64_t size) : bytes_(std::move(bytes)), size_(size) {}

  std::uint64_t size() const override { return size_; }
  Result<void> read(std::uint64_t offset, void* to, std::size_t count) const override {
    read_ += count;
    if (offset + count > bytes_.size()) return fail(ErrorCode::Unreadable, "gone");
    std::memcpy(to, bytes_.data() + offset, count);
    return {};
  }
  std::size_t read_count() const { return read_; }

 private:
  std::string bytes_;
  std::uint64_t size_;
  mutable std::size_t read_ = 0;
};

std::string cache_bytes(const std::string& name, int samples, int vertices) {
  const ScratchFolder folder;
  const std::vector<Field> all(static_cast<std::size_t>(samples), Field::Random(vertices, 3));
  return read_file(write_cache(folder, name, all, 5)).value();
}

}  // namespace

TEST_CASE("a layout tells where each format has its numbers", "[mesh][cache]") {
  using Clock = CacheLayout::Clock;
  for (const auto& [name, clock] :
       {std::pair("a.pc2", Clock::Frames), {"a.mdd", Clock::Seconds}, {"a.npy", Clock::Samples}}) {
    CAPTURE(name);
    const std::string bytes = cache_bytes(name, 3, 7);
    const CacheLayout layout = read_layout(NotingBytes(bytes), name).value();
    CHECK(layout.clock == clock);
    CHECK(layout.sample_count == 3);
    CHECK(layout.vertex_count == 7);
    CHECK((layout.byte_order == std::endian::big) == (clock == Clock::Seconds));
    CHECK(layout.is_double == (clock == Clock::Samples));
    CHECK(layout.seconds.size() == (clock == Clock::Seconds ? 3 : 0));
    CHECK(layout.begin + 3 * layout.sample_bytes() == bytes.size());
  }
  const CacheLayout pc2 = read_layout(NotingBytes(cache_bytes("a.pc2", 3, 7)), "a.pc2").value();
  CHECK(pc2.start == 5);
  CHECK(pc2.step == 1);
}

TEST_CASE("a head that promises too much is refused before more of it is read", "[mesh][cache]") {
  // 2^31 - 1 samples, whose times alone would have 8 GB.
  std::string mdd = cache_bytes("a.mdd", 2, 3);
  std::memcpy(mdd.data(), "\x7f\xff\xff\xff", 4);
  const NotingBytes bytes(mdd);
  const auto refused = read_layout(bytes, "a.mdd");
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("truncated"));
  CHECK(bytes.read_count() == 8);
}

TEST_CASE("a sparse file of too many samples is refused before they take memory", "[mesh][cache]") {
  class SparseMdd final : public CacheBytes {
   public:
    std::uint64_t size() const override { return std::uint64_t{1} << 40; }
    Result<void> read(std::uint64_t, void* to, std::size_t count) const override {
      REQUIRE(count == 8);
      std::memcpy(to, "\x7f\xff\xff\xff\x00\x00\x00\x01", count);
      return {};
    }
  };
  const auto refused = read_layout(SparseMdd(), "a.mdd");
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().message, Contains("at most 10000000 are read"));
}

TEST_CASE("numbers are not read for a layout", "[mesh][cache]") {
  for (const char* name : {"a.pc2", "a.mdd"}) {
    const NotingBytes bytes(cache_bytes(name, 4, 1000));
    REQUIRE(read_layout(bytes, name));
    CHECK(bytes.read_count() <= 32);
  }
}

TEST_CASE("what cannot be read is no layout", "[mesh][cache]") {
  for (const char* name : {"a.pc2", "a.mdd", "a.npy"}) {
    CAPTURE(name);
    const auto refused = read_layout(NotingBytes("", 1000), name);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::Unreadable);
  }
  // The times of a .mdd, after a head that is well.
  const std::string mdd = cache_bytes("a.mdd", 2, 3);
  const auto refused = read_layout(NotingBytes(mdd.substr(0, 8), mdd.size()), "a.mdd");
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::Unreadable);
}

TEST_CASE("a name decides the format, in letters of any case", "[mesh][cache]") {
  const std::string bytes = cache_bytes("a.pc2", 2, 3);
  CHECK(read_layout(NotingBytes(bytes), "A.PC2"));
  for (const char* name : {"a.mdd", "a.npy", "a", "pc2"})
    CHECK_FALSE(read_layout(NotingBytes(bytes), name));
}
