#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant::ply {

// The header of a PLY file: what its elements consist of. Internal to mesh.

enum class Encoding { Ascii, LittleEndian, BigEndian };

enum class NumberType { Int8, UInt8, Int16, UInt16, Int32, UInt32, Float32, Float64 };

struct Property {
  std::string name;
  NumberType type = NumberType::Float32;
  std::optional<NumberType> count_type = {};  ///< set for a list
};

struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::vector<Property> properties;

  /// The index of the first property with one of these names; -1: there is none.
  int find(std::initializer_list<std::string_view> names) const;
};

struct Header {
  Encoding encoding = Encoding::Ascii;
  std::vector<PlyElement> elements;
  std::size_t size = 0;  ///< offset of the elements
  int line_count = 0;
};

// The names of what is read; all other elements and properties are skipped.

/// Those of a vertex besides x, y and z: of its normal, and of its (u,v) in the order in which they
/// are looked for.
inline constexpr std::array<std::string_view, 3> normal_names = {"nx", "ny", "nz"};
inline constexpr std::array<std::array<std::string_view, 2>, 4> uv_names = {
    {{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}, {"tx", "ty"}}};

/// Numbered (u,v): an element with the properties `u` and `v`, and the list of a face with their
/// numbers. Its other list has equal numbers for corners that share a normal. Pliant's own.
inline constexpr std::string_view uv_element = "texcoord", uv_indices = "texcoord_indices",
                                  normal_indices = "normal_indices";

/// The bytes of a number of that type in a binary file.
std::size_t size_of(NumberType type);

/// Reads the header at the beginning of a file. Errors: there is none, it does not end, or a line
/// of it is not part of one; Interrupted.
Result<Header> read_header(std::string_view bytes, const StopRequest& should_stop = {});

}  // namespace pliant::ply
