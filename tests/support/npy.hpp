#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "pliant/files/read_file.hpp"

namespace pliant::testing {

/// A .npy file of float64 parsed according to its header, without the writer's code.
struct NpyFile {
  std::string header;      ///< the Python literal
  std::size_t offset = 0;  ///< of the numbers in the file
  std::vector<double> numbers;

  static NpyFile read(const std::filesystem::path& file) {
    const std::string bytes = read_file(file).value();
    NpyFile npy;
    if (bytes.size() < 10 || bytes.compare(0, 8, std::string("\x93NUMPY\x01\x00", 8)) != 0)
      return npy;
    const std::size_t length =
        static_cast<unsigned char>(bytes[8]) + 256u * static_cast<unsigned char>(bytes[9]);
    npy.header = bytes.substr(10, length);
    npy.offset = 10 + length;
    npy.numbers.resize((bytes.size() - npy.offset) / sizeof(double));
    std::memcpy(npy.numbers.data(), bytes.data() + npy.offset, npy.numbers.size() * sizeof(double));
    return npy;
  }
};

}  // namespace pliant::testing
