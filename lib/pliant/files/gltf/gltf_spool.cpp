#include "pliant/files/gltf/gltf_spool.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "pliant/core/byte_order.hpp"
#include "pliant/files/raw_bytes.hpp"

namespace pliant {
namespace {

using Json = GltfBuffer::Json;

// Component types and targets: their numbers in the format.
constexpr int unsigned_byte = 5121;
constexpr int unsigned_short = 5123;
constexpr int unsigned_int = 5125;
constexpr int floating = 5126;
constexpr int no_target = 0;
constexpr int array_buffer = 34962;
constexpr int element_array_buffer = 34963;

const char* type_of(int width) {
  constexpr std::array types = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  return types[static_cast<std::size_t>(width - 1)];
}

// The minimum and maximum of each component, as the format requires: of the numbers as written.
// Wrong if it is stopped.
void set_bounds(Json& accessor, std::span<const float> numbers, int width, StopPoll& poll) {
  std::vector<float> least(numbers.begin(), numbers.begin() + width), largest = least;
  for (std::size_t k = 0; k < numbers.size() && !poll.after(4); ++k) {
    const std::size_t component = k % static_cast<std::size_t>(width);
    least[component] = std::min(least[component], numbers[k]);
    largest[component] = std::max(largest[component], numbers[k]);
  }
  // As doubles: every program parses their shortest text to the same number.
  accessor["min"] = std::vector<double>(least.begin(), least.end());
  accessor["max"] = std::vector<double>(largest.begin(), largest.end());
}

// Indices in the narrowest type that can store the largest of them.
struct PackedIndices {
  int component_type;
  std::string bytes;
};

PackedIndices packed(std::span<const std::uint32_t> indices) {
  const std::uint32_t largest = *std::max_element(indices.begin(), indices.end());
  const int size = largest <= 0xff ? 1 : largest <= 0xffff ? 2 : 4;
  PackedIndices result{size == 1 ? unsigned_byte : size == 2 ? unsigned_short : unsigned_int, {}};
  result.bytes.reserve(indices.size() * static_cast<std::size_t>(size));
  for (const std::uint32_t index : indices) {
    append_number(result.bytes, index);
    result.bytes.resize(result.bytes.size() - sizeof(index) + static_cast<std::size_t>(size));
  }
  return result;
}

constexpr std::size_t padded(std::size_t bytes) { return (bytes + 3) / 4 * 4; }

}  // namespace

Result<void> GltfBuffer::write(std::string_view bytes) {
  if (auto written = sink_(bytes); !written) return written;
  size_ += bytes.size();
  return {};
}

// Every view begins at a multiple of 4, which is correct for all types.
Result<std::size_t> GltfBuffer::add_view(std::string_view bytes, int target) {
  Json view = {{"buffer", 0}, {"byteOffset", size_}, {"byteLength", bytes.size()}};
  if (target != no_target) view["target"] = target;
  if (auto written = write(bytes); !written) return fail(written.error());
  const std::string padding(padded(bytes.size()) - bytes.size(), '\0');
  if (auto written = write(padding); !written) return fail(written.error());
  views_.push_back(std::move(view));
  return views_.size() - 1;
}

std::size_t GltfBuffer::add_accessor(Json accessor) {
  accessors_.push_back(std::move(accessor));
  return accessors_.size() - 1;
}

Result<std::size_t> GltfBuffer::add_rows(std::span<const float> numbers, int width, Bounds bounds,
                                         int target) {
  const auto view = add_view(bytes_of(numbers), target);
  if (!view) return fail(view.error());
  Json accessor = {{"bufferView", *view},
                   {"componentType", floating},
                   {"count", numbers.size() / static_cast<std::size_t>(width)},
                   {"type", type_of(width)}};
  StopPoll poll(should_stop_);
  if (bounds == Bounds::Written) set_bounds(accessor, numbers, width, poll);
  if (poll.after(0)) return interrupted();
  return add_accessor(std::move(accessor));
}

Result<std::size_t> GltfBuffer::add_vertices(std::span<const float> numbers, int width,
                                             Bounds bounds) {
  return add_rows(numbers, width, bounds, array_buffer);
}

Result<std::size_t> GltfBuffer::add_offsets(std::span<const float> numbers, Bounds bounds) {
  std::vector<std::uint32_t> rows;  // rows that are not 0
  std::vector<float> values;
  StopPoll poll(should_stop_);
  const auto count = static_cast<std::uint32_t>(numbers.size() / 3);
  for (std::uint32_t row = 0; row < count; ++row) {
    if (poll.after(4)) return interrupted();
    const auto offset = numbers.subspan(std::size_t{3} * row, 3);
    if (offset[0] == 0 && offset[1] == 0 && offset[2] == 0) continue;
    rows.push_back(row);
    values.insert(values.end(), offset.begin(), offset.end());
  }
  const PackedIndices indices = rows.empty() ? PackedIndices{} : packed(rows);
  if (padded(indices.bytes.size()) + values.size() * sizeof(float) >= numbers.size_bytes())
    return add_vertices(numbers, 3, bounds);

  Json accessor = {{"componentType", floating}, {"count", count}, {"type", "VEC3"}};
  if (bounds == Bounds::Written) set_bounds(accessor, numbers, 3, poll);
  if (poll.after(0)) return interrupted();
  if (!rows.empty()) {
    const auto index_view = add_view(indices.bytes, no_target);
    if (!index_view) return fail(index_view.error());
    const auto value_view = add_view(bytes_of(std::span<const float>(values)), no_target);
    if (!value_view) return fail(value_view.error());
    accessor["sparse"] = {
        {"count", rows.size()},
        {"indices", {{"bufferView", *index_view}, {"componentType", indices.component_type}}},
        {"values", {{"bufferView", *value_view}}}};
  }
  return add_accessor(std::move(accessor));
}

Result<std::size_t> GltfBuffer::add_indices(std::span<const std::uint32_t> indices) {
  const std::uint32_t largest = *std::max_element(indices.begin(), indices.end());
  // In graphics libraries the largest number of a type restarts a primitive.
  const bool is_short = largest < 0xffff;
  const std::vector<std::uint16_t> shorts(is_short ? indices.begin() : indices.end(),
                                          indices.end());
  const auto view =
      add_view(is_short ? bytes_of(std::span<const std::uint16_t>(shorts)) : bytes_of(indices),
               element_array_buffer);
  if (!view) return fail(view.error());
  return add_accessor({{"bufferView", *view},
                       {"componentType", is_short ? unsigned_short : unsigned_int},
                       {"count", indices.size()},
                       {"type", "SCALAR"}});
}

Result<std::size_t> GltfBuffer::add_keys(std::span<const float> numbers, int width, Bounds bounds) {
  return add_rows(numbers, width, bounds, no_target);
}

Result<std::size_t> GltfBuffer::add_weights(std::span<const int> target_of_key, int target_count) {
  const std::size_t count = target_of_key.size() * static_cast<std::size_t>(target_count);
  views_.push_back({{"buffer", 0}, {"byteOffset", size_}, {"byteLength", count * sizeof(float)}});
  std::vector<float> row(static_cast<std::size_t>(target_count), 0.0f);
  for (const int target : target_of_key) {
    if (target >= 0) row[static_cast<std::size_t>(target)] = 1;
    if (auto written = write(bytes_of(std::span<const float>(row))); !written)
      return fail(written.error());
    if (target >= 0) row[static_cast<std::size_t>(target)] = 0;
  }
  return add_accessor({{"bufferView", views_.size() - 1},
                       {"componentType", floating},
                       {"count", count},
                       {"type", "SCALAR"}});
}

}  // namespace pliant
