// Arbitrary bytes as a map of a material: the first one selects the format, the others are the
// file.

#include <array>
#include <cmath>
#include <string>

#include "fuzz.hpp"
#include "pliant/files/npy/npy_grid.hpp"
#include "pliant/files/ply/read_ply.hpp"
#include "pliant/files/png/read_png.hpp"

using namespace pliant;
using namespace pliant::fuzzing;

namespace {

void check_picture(std::string_view bytes) {
  const auto size = bytes_of_png(bytes);
  const auto picture = parse_png(bytes, "fuzz");
  if (!picture) return check_error(picture.error());
  require(size && *size == 2 * picture->values.size());
  for (const double u : {-1.0, 0.0, 0.3, 0.5, 1.0}) {
    for (const double v : {-1e300, 0.0, 0.7, 0.5, 2.0}) {
      const double value = picture->at(u, v);
      require(0 <= value && value <= 1);
    }
  }
}

void check_npy(std::string_view bytes) {
  const auto values = parse_npy_grid(bytes, "fuzz", 3, 2);
  if (!values) return check_error(values.error());
  require(values->size() == 6);
  for (const double value : *values) require(std::isfinite(value));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view file = text_of(bytes + 1, size - 1);
  if (bytes[0] % 3 == 0) check_picture(file);
  if (bytes[0] % 3 == 1) check_npy(file);
  if (bytes[0] % 3 == 2) {
    const std::array<std::string, 1> names = {"m"};
    check_read(parse_ply(file, "fuzz", "", names));
  }
  return 0;
}
