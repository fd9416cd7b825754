#include "pliant/files/npy/npy_grid.hpp"

#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "support/catch.hpp"

using namespace pliant;
using Catch::Matchers::Contains;

namespace {

std::string npy_text(const std::string& shape, const std::vector<double>& numbers) {
  const std::string literal =
      fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': {}, }}\n", shape);
  std::string bytes = "\x93NUMPY";
  bytes += {'\1', '\0', static_cast<char>(literal.size()), '\0'};
  bytes += literal;
  for (const double number : numbers) {
    char eight[8];
    std::memcpy(eight, &number, 8);
    bytes.append(eight, 8);
  }
  return bytes;
}

std::string problem_of_grid(const std::string& bytes) {
  const auto grid = parse_npy_grid(bytes, "m.npy", 3, 2);
  if (grid) return "none";
  CHECK(grid.error().file == "m.npy");
  return grid.error().message;
}

}  // namespace

TEST_CASE("the numbers of a .npy are those of a grid's nodes, row by row", "[mesh][maps]") {
  const std::vector<double> numbers = {1, 2, 3, 4, 5, 0.1};
  CHECK(parse_npy_grid(npy_text("(2, 3)", numbers), "a", 3, 2).value() == numbers);
  CHECK(parse_npy_grid(npy_text("(2, 3,)", numbers), "a", 3, 2).value() == numbers);
}

TEST_CASE("a .npy that is no grid of the right size says so", "[mesh][maps]") {
  const std::vector<double> numbers = {1, 2, 3, 4, 5, 6};
  for (const char* shape : {"(3, 2)", "(6,)", "(2, 3, 1)", "()", "(2, x)", "(2, 99999999999999)"})
    CHECK_THAT(
        problem_of_grid(npy_text(shape, numbers)),
        Contains(fmt::format("its shape is {}, but the grid's is (2, 3): rows, columns", shape)));
  CHECK_THAT(problem_of_grid(npy_text("(2, 3)", {1, 2, 3})),
             Contains("it promises 6 numbers, but has 3"));
  CHECK_THAT(problem_of_grid(
                 npy_text("(2, 3)", {1, 2, 3, 4, std::numeric_limits<double>::quiet_NaN(), 6})),
             Contains("row 1, column 1 is nan, which is not finite"));
  CHECK_THAT(problem_of_grid("\x89PNG"), Contains("the head of a .npy has 10"));
  const std::string whole = npy_text("(2, 3)", numbers);
  for (std::size_t size = 0; size < whole.size(); ++size)
    CHECK(problem_of_grid(whole.substr(0, size)) != "none");
}
