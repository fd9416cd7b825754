#include "pliant/files/gltf/gltf_accessor.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/byte_order.hpp"
#include "pliant/files/file_object.hpp"

namespace pliant::gltf {
namespace {

constexpr std::size_t parts_of_element = 16;

enum class Component : std::uint64_t {
  Int8 = 5120,
  UInt8 = 5121,
  Int16 = 5122,
  UInt16 = 5123,
  UInt32 = 5125,
  Float32 = 5126
};

// [bytes]; 0: unknown type.
std::size_t size_of(std::uint64_t component) {
  switch (static_cast<Component>(component)) {
    case Component::Int8:
    case Component::UInt8:
      return 1;
    case Component::Int16:
    case Component::UInt16:
      return 2;
    case Component::UInt32:
    case Component::Float32:
      return 4;
  }
  return 0;
}

bool is_index(std::uint64_t component) {
  const auto kind = static_cast<Component>(component);
  return kind == Component::UInt8 || kind == Component::UInt16 || kind == Component::UInt32;
}

// Fraction of the largest value, at least -1: glTF 2.0, 3.11 (animations) and
// KHR_mesh_quantization.
double number_at(const char* at, std::uint64_t component, bool is_normalized) {
  const auto read = [&]<class Number>(Number largest) {
    const double number = number_from<Number>(at);
    return is_normalized ? std::max(number / largest, -1.0) : number;
  };
  switch (static_cast<Component>(component)) {
    case Component::Int8:
      return read(std::numeric_limits<std::int8_t>::max());
    case Component::UInt8:
      return read(std::numeric_limits<std::uint8_t>::max());
    case Component::Int16:
      return read(std::numeric_limits<std::int16_t>::max());
    case Component::UInt16:
      return read(std::numeric_limits<std::uint16_t>::max());
    case Component::UInt32:
      return number_from<std::uint32_t>(at);
    case Component::Float32:
      return number_from<float>(at);
  }
  return 0;
}

}  // namespace

struct AccessorReader::Read {
  std::size_t number;
  const Accessor& accessor;
  std::size_t width;  // numbers per element

  std::size_t element_size() const { return width * size_of(accessor.component_type); }

  tl::unexpected<Error> broken(std::string_view rule) const {
    return fail(ErrorCode::InvalidInput, fmt::format("accessors[{}] {}", number, rule));
  }
};

Result<std::vector<double>> AccessorReader::vectors(std::size_t accessor, int width) {
  const Read read{accessor, document_.accessors[accessor], static_cast<std::size_t>(width)};
  const std::uint64_t component = read.accessor.component_type;
  if (read.accessor.type != fmt::format("VEC{}", width)) {
    return read.broken(
        fmt::format("is of type {}, not VEC{}", in_quotes(read.accessor.type), width));
  }
  if (size_of(component) == 0 || static_cast<Component>(component) == Component::UInt32)
    return read.broken(
        fmt::format("has the componentType {}, which vectors must not have", component));
  return this->read(read);
}

Result<std::vector<double>> AccessorReader::scalars(std::size_t accessor) {
  const Read read{accessor, document_.accessors[accessor], 1};
  if (read.accessor.type != "SCALAR")
    return read.broken(fmt::format("is of type {}, not SCALAR", in_quotes(read.accessor.type)));
  if (size_of(read.accessor.component_type) == 0)
    return read.broken(fmt::format("has the componentType {}, which numbers must not have",
                                   read.accessor.component_type));
  return this->read(read);
}

Result<std::vector<std::uint32_t>> AccessorReader::indices(std::size_t accessor) {
  const Read read{accessor, document_.accessors[accessor], 1};
  if (read.accessor.type != "SCALAR")
    return read.broken(fmt::format("is of type {}, not SCALAR", in_quotes(read.accessor.type)));
  if (!is_index(read.accessor.component_type) || read.accessor.is_normalized) {
    return read.broken(fmt::format(
        "has the componentType {}{}; indices must have 5121, 5123 or 5125",
        read.accessor.component_type, read.accessor.is_normalized ? ", normalized" : ""));
  }
  const auto numbers = this->read(read);
  if (!numbers) return fail(numbers.error());
  return std::vector<std::uint32_t>(numbers->begin(), numbers->end());  // exact in double
}

Result<std::vector<double>> AccessorReader::read(const Read& read) {
  const Accessor& accessor = read.accessor;
  std::optional<StridedBytes> source;
  if (accessor.view) {
    const auto found =
        strided_bytes(read, *accessor.view, accessor.offset, accessor.count, read.element_size());
    if (!found) return fail(found.error());
    source = *found;
  }
  if (auto charged = charge(read.number); !charged) return fail(charged.error());
  const auto count = static_cast<std::size_t>(accessor.count);
  std::vector<double> numbers(count * read.width);
  const std::size_t size = size_of(accessor.component_type);
  StopPoll poll(should_stop_);
  for (std::size_t k = 0; source && k < count; ++k) {
    if (poll.after(parts_of_element)) return interrupted();
    const char* const element = source->bytes.data() + k * source->stride;
    for (std::size_t n = 0; n < read.width; ++n) {
      numbers[k * read.width + n] =
          number_at(element + n * size, accessor.component_type, accessor.is_normalized);
    }
  }
  if (auto put = put_sparse(read, numbers, poll); !put) return fail(put.error());
  return numbers;
}

// No difference below can be negative, so no unsigned number wraps around.
Result<AccessorReader::StridedBytes> AccessorReader::strided_bytes(const Read& read,
                                                                   std::size_t view_number,
                                                                   std::uint64_t offset,
                                                                   std::uint64_t count,
                                                                   std::size_t element_size) const {
  const BufferView& view = document_.views[view_number];
  const auto buffer = buffers_.bytes(view.buffer);
  if (!buffer) return fail(buffer.error());
  if (view.offset > buffer->size() || view.size > buffer->size() - view.offset) {
    return fail(ErrorCode::InvalidInput,
                fmt::format("bufferViews[{}] reaches past the end of its buffer: {} bytes at {} "
                            "of {}",
                            view_number, view.size, view.offset, buffer->size()));
  }
  const std::uint64_t stride = view.stride > 0 ? view.stride : element_size;
  if (stride < element_size) {
    return read.broken(fmt::format("has elements of {} bytes, but bufferViews[{}].byteStride is {}",
                                   element_size, view_number, stride));
  }
  if (count == 0) return StridedBytes{{}, static_cast<std::size_t>(stride)};
  const bool is_within = offset <= view.size && element_size <= view.size - offset &&
                         count - 1 <= (view.size - offset - element_size) / stride;
  if (!is_within) {
    return read.broken(
        fmt::format("reaches past the end of bufferViews[{}]: {} elements at byte "
                    "{} of {}",
                    view_number, count, offset, view.size));
  }
  return StridedBytes{buffer->substr(static_cast<std::size_t>(view.offset + offset),
                                     static_cast<std::size_t>((count - 1) * stride + element_size)),
                      static_cast<std::size_t>(stride)};
}

Result<void> AccessorReader::put_sparse(const Read& read, std::vector<double>& numbers,
                                        StopPoll& poll) const {
  const Accessor& accessor = read.accessor;
  if (!accessor.sparse) return {};
  const Sparse& sparse = *accessor.sparse;
  if (sparse.count > accessor.count) {
    return read.broken(fmt::format("replaces {} of its {} elements", sparse.count, accessor.count));
  }
  if (!is_index(sparse.index_type)) {
    return read.broken(fmt::format(
        "has sparse indices of the componentType {}; indices must have 5121, 5123 or 5125",
        sparse.index_type));
  }
  const std::size_t index_size = size_of(sparse.index_type);
  const std::size_t size = size_of(accessor.component_type);
  const auto indices =
      strided_bytes(read, sparse.index_view, sparse.index_offset, sparse.count, index_size);
  if (!indices) return fail(indices.error());
  const auto values = strided_bytes(read, sparse.value_view, sparse.value_offset, sparse.count,
                                    read.element_size());
  if (!values) return fail(values.error());
  std::uint64_t least = 0;
  for (std::size_t k = 0; k < sparse.count; ++k) {
    if (poll.after(parts_of_element)) return interrupted();
    const std::uint64_t index = bits_from(indices->bytes.data() + k * indices->stride, index_size);
    if (index < least || index >= accessor.count) {
      return read.broken(fmt::format(
          "has the sparse index {}, but must have one from {} to {} after those before it", index,
          least, accessor.count - 1));
    }
    least = index + 1;
    const char* const element = values->bytes.data() + k * values->stride;
    for (std::size_t n = 0; n < read.width; ++n) {
      numbers[index * read.width + n] =
          number_at(element + n * size, accessor.component_type, accessor.is_normalized);
    }
  }
  return {};
}

// An element with its own bytes in a file needs at least one byte.
Result<void> AccessorReader::charge(std::size_t accessor) {
  const std::uint64_t count = document_.accessors[accessor].count;
  const std::uint64_t most = std::min<std::uint64_t>(
      buffers_.size_so_far() + most_elements_beyond_bytes, std::numeric_limits<int>::max());
  if (elements_read_ <= most && count <= most - elements_read_) {
    elements_read_ += count;
    return {};
  }
  return fail(ErrorCode::InvalidInput,
              fmt::format("accessors[{}] has {} elements, and {} were read before it: more than "
                          "the {} that a file of this size may have",
                          accessor, count, elements_read_, most));
}

}  // namespace pliant::gltf
