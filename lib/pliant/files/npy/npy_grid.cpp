#include "pliant/files/npy/npy_grid.hpp"

#include <cmath>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/byte_order.hpp"
#include "pliant/files/npy/npy_header.hpp"

namespace pliant {
namespace {

double number_in_npy(const char* bytes, const NpyHeader& header) {
  return header.is_double ? number_from<double>(bytes, header.byte_order)
                          : number_from<float>(bytes, header.byte_order);
}

}  // namespace

Result<std::vector<double>> parse_npy_grid(std::string_view bytes, const std::string& name,
                                           int columns, int rows, const StopRequest& should_stop) {
  constexpr std::size_t parts_of_number = 16;
  const auto refuse = [&](std::string message) {
    return fail(ErrorCode::InvalidInput, std::move(message), name);
  };
  const auto header = read_npy_header(bytes, bytes.size());
  if (!header) return refuse(header.error().message);
  const auto width = static_cast<std::uint64_t>(columns), height = static_cast<std::uint64_t>(rows);
  if (header->shape != std::vector<std::uint64_t>{height, width})
    return refuse(fmt::format("its shape is {}, but the grid's is ({}, {}): rows, columns",
                              header->shape_text, rows, columns));
  const std::size_t count = static_cast<std::size_t>(width * height), size = header->number_size();
  const std::string_view numbers = bytes.substr(static_cast<std::size_t>(header->begin));
  if (numbers.size() / size < count)
    return refuse(fmt::format("it is truncated: it promises {} numbers, but has {}", count,
                              numbers.size() / size));
  std::vector<double> values(count);
  StopPoll poll(should_stop);
  for (std::size_t k = 0; k < count; ++k) {
    if (poll.after(parts_of_number)) return interrupted();
    values[k] = number_in_npy(numbers.data() + k * size, *header);
    if (!std::isfinite(values[k]))
      return refuse(fmt::format("the number in row {}, column {} is {}, which is not finite",
                                k / width, k % width, values[k]));
  }
  return values;
}

}  // namespace pliant
