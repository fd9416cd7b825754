#include "pliant/files/caches/point_cache.hpp"

#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "pliant/files/read_file.hpp"
#include "support/caches.hpp"
#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

// Numbers that single precision holds.
std::vector<Field> some_samples(int count, int vertices) {
  std::vector<Field> samples;
  for (int k = 0; k < count; ++k) {
    Field field(vertices, 3);
    for (int row = 0; row < vertices; ++row) {
      field.row(row) << 0.25 * row + k, -0.5 * k * row, 1.0 / (1 << (row % 20)) - k;
    }
    samples.push_back(field);
  }
  return samples;
}

std::string number_bytes(double number, std::string_view type) {
  std::string bytes(type[2] == '8' ? 8 : 4, '\0');
  if (type[2] == '8') {
    std::memcpy(bytes.data(), &number, 8);
  } else {
    const auto single = static_cast<float>(number);
    std::memcpy(bytes.data(), &single, 4);
  }
  const bool is_big = type[0] == '>';
  if (is_big != (std::endian::native == std::endian::big)) std::ranges::reverse(bytes);
  return bytes;
}

std::string npy(const std::string& literal, const std::string& numbers, char version = 1) {
  std::string text = literal + '\n';
  std::string bytes = "\x93NUMPY";
  bytes += {version, '\0'};
  bytes += static_cast<char>(text.size() & 0xff);
  bytes += static_cast<char>(text.size() >> 8);
  if (version > 1) bytes += {'\0', '\0'};
  return bytes + text + numbers;
}

std::string npy_of(const std::vector<Field>& samples, std::string_view type, char version = 1) {
  std::string numbers;
  for (const Field& sample : samples) {
    for (Eigen::Index row = 0; row < sample.rows(); ++row) {
      for (int k = 0; k < 3; ++k) numbers += number_bytes(sample(row, k), type);
    }
  }
  return npy(fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}, {}, 3), }}", type,
                         samples.size(), samples.front().rows()),
             numbers, version);
}

std::string message_of(const Result<PointCache>& cache) {
  REQUIRE_FALSE(cache);
  CHECK(cache.error().message.find('\n') == std::string::npos);
  return cache.error().message;
}

std::string refusal(std::string bytes, const std::string& name) {
  return message_of(PointCache::of_bytes(std::move(bytes), name));
}

}  // namespace

TEST_CASE("what the writers of caches write, the reader reads back", "[mesh][cache]") {
  const ScratchFolder folder;
  const auto samples = some_samples(4, 5000);  // more than one block of rows
  for (const char* name : {"a.npy", "a.pc2", "A.MDD"}) {
    CAPTURE(name);
    const auto cache = PointCache::open(write_cache(folder, name, samples, -3));
    REQUIRE(cache);
    CHECK(cache->sample_count() == 4);
    CHECK(cache->vertex_count() == 5000);
    for (const int sample : {2, 0, 3, 1}) CHECK(cache->read(sample).value() == samples[sample]);
    const bool has_own = ending_of(name) == ".pc2";
    CHECK(cache->frames({}, 7, 24).value() ==
          (has_own ? std::vector<double>{-3, -2, -1, 0} : std::vector<double>{7, 8, 9, 10}));
    CHECK(cache->frames(2.5, 7, 24).value() == std::vector<double>{2.5, 3.5, 4.5, 5.5});
  }
}

TEST_CASE("a .npy of either precision, either order of bytes and every version is read",
          "[mesh][cache]") {
  const auto samples = some_samples(3, 7);
  for (const char* type : {"<f4", "<f8", ">f4", ">f8"}) {
    for (const char version : {'\1', '\2', '\3'}) {
      CAPTURE(type, int{version});
      const auto cache = PointCache::of_bytes(npy_of(samples, type, version), "a.npy");
      REQUIRE(cache);
      for (int k = 0; k < 3; ++k) CHECK(cache->read(k).value() == samples[k]);
    }
  }
  const auto not_single =
      PointCache::of_bytes(npy_of({Field::Constant(1, 3, 0.1)}, "<f8"), "a.npy");
  CHECK(not_single->read(0).value()(0, 0) == 0.1);
}

TEST_CASE("seconds of a .mdd are frames wherever single precision allows", "[mesh][cache]") {
  const ScratchFolder folder;
  const auto samples = some_samples(2000, 1);
  for (const double fps : {24.0, 25.0, 30.0, 24000.0 / 1001, 12.5}) {
    CAPTURE(fps);
    const auto cache = PointCache::open(write_cache(folder, "a.mdd", samples, 1, fps)).value();
    const auto frames = cache.frames({}, 1, fps).value();
    for (std::size_t k = 0; k < frames.size(); ++k) REQUIRE(frames[k] == 1.0 + double(k));
    // At another rate they are between.
    const auto half = cache.frames({}, 1, fps / 2).value();
    CHECK_THAT(half[3], WithinAbs(2.5, 1e-6));
  }
}

TEST_CASE("a cache that breaks a rule of its format is refused with the rule", "[mesh][cache]") {
  using Catch::Matchers::Contains;
  const ScratchFolder folder;
  const auto bytes_of = [&](const std::string& name) {
    return read_file(write_cache(folder, name, some_samples(2, 3))).value();
  };
  const auto with = [](std::string bytes, std::size_t at, const std::string& other) {
    return bytes.replace(at, other.size(), other);
  };
  const std::string pc2 = bytes_of("a.pc2"), mdd = bytes_of("a.mdd");
  const std::string zero(4, '\0'), minus_one(4, '\xff');
  CHECK_THAT(refusal(pc2, "a.abc"), Contains(".pc2, .mdd or .npy"));
  CHECK_THAT(refusal(with(pc2, 0, "X"), "a.pc2"), Contains("POINTCACHE2"));
  CHECK_THAT(refusal(with(pc2, 12, "\x02"), "a.pc2"), Contains("version is 2"));
  CHECK_THAT(refusal(with(pc2, 16, zero), "a.pc2"), Contains("0 vertices"));
  CHECK_THAT(refusal(with(pc2, 28, minus_one), "a.pc2"), Contains("0 samples"));
  CHECK_THAT(refusal(with(pc2, 24, zero), "a.pc2"), Contains("sample rate is 0"));
  CHECK_THAT(refusal(with(pc2, 20, minus_one), "a.pc2"), Contains("start frame"));
  CHECK_THAT(refusal(with(pc2, 16, std::string("\xff\xff\xff\x7f", 4)), "a.pc2"),
             Contains("truncated"));
  CHECK_THAT(refusal(with(mdd, 0, std::string("\x7f\xff\xff\xff", 4)), "a.mdd"),
             Contains("truncated"));
  CHECK_THAT(refusal(npy_of(some_samples(2, 3), "<i8"), "a.npy"), Contains("<i8"));
  const auto shaped = [](const std::string& shape, const std::string& order = "False") {
    return refusal(npy("{'descr': '<f8', 'fortran_order': " + order + ", 'shape': " + shape + "}",
                       std::string(240, '\0')),
                   "a.npy");
  };
  CHECK_THAT(shaped("(2, 3, 3)", "True"), Contains("ascontiguousarray"));
  CHECK_THAT(shaped("(2, 3, 3)", "Maybe"), Contains("fortran_order"));
  for (const char* shape : {"(2, 3)", "(2, 3, 4)", "(2, 3, 3, 3)", "(2, 3, 3", "(2, -3, 3)", "()"})
    CHECK_THAT(shaped(shape), Contains("shape"));
  CHECK_THAT(shaped("(9223372036854775807, 9223372036854775807, 3)"), Contains("samples"));
  CHECK_THAT(shaped("(2147483647, 2147483647, 3)"), Contains("truncated"));
  CHECK_THAT(refusal(npy("{}", ""), "a.npy"), Contains("lacks"));

  const auto repeated = with(mdd, 12, mdd.substr(8, 4));  // both times are the first one's
  CHECK_THAT(PointCache::of_bytes(repeated, "a.mdd")->frames({}, 1, 24).error().message,
             Contains("must be after sample 0"));
  CHECK_THAT(
      PointCache::of_bytes(with(mdd, 12, minus_one), "a.mdd")->frames({}, 1, 24).error().message,
      Contains("finite"));
  CHECK(PointCache::open(folder.file("no.pc2")).error().code == ErrorCode::Unreadable);
  CHECK(PointCache::open(folder.path()).error().code == ErrorCode::Unreadable);
  CHECK(PointCache::open("/dev/zero").error().code == ErrorCode::Unreadable);
}

TEST_CASE("every truncated prefix of a cache is refused", "[mesh][cache]") {
  const ScratchFolder folder;
  for (const char* name : {"a.npy", "a.pc2", "a.mdd"}) {
    const std::string bytes = read_file(write_cache(folder, name, some_samples(2, 3))).value();
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      CAPTURE(name, length);
      CHECK_FALSE(PointCache::of_bytes(bytes.substr(0, length), name));
    }
    CHECK(PointCache::of_bytes(bytes + "more", name));
  }
}

TEST_CASE("a cache that becomes shorter while it is open is an error", "[mesh][cache]") {
  const ScratchFolder folder;
  const std::string file = write_cache(folder, "a.pc2", some_samples(3, 100));
  const auto cache = PointCache::open(file).value();
  std::filesystem::resize_file(file, 40);
  const auto read = cache.read(2);
  REQUIRE_FALSE(read);
  CHECK(read.error().code == ErrorCode::Unreadable);
}
