#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace pliant {

// The answer of the sandboxed reader of mesh files: numbers in the byte order of this machine,
// since both ends run on it. `files/boxed/program/write_message.cpp` writes it. Internal to mesh.
//
//   u64 message_begin, u32 kind
//   Refused:  text (u32 length, bytes)
//   Scene:    u32 number of objects; of each: text node, text mesh,
//               u64 vertices, u64 faces, u64 faces that are left out
//             u32 index of the chosen object, or no_object and then nothing more
//             16 f64, the transform by rows; u32 number of submeshes; of each:
//               text material, u32 sets of (u,v) as bits, u32 is_lit, u32 has_uvs
//               u32 vertices, u32 faces, u32 corners
//               f32 3 per vertex; if is_lit f32 3 per vertex; if has_uvs f32 2 per vertex
//               u32 per face: its corners; u32 per corner: its vertex
//   u64 message_end

inline constexpr std::uint64_t message_begin = 0x31'48'53'45'4d'49'4c'50;  // "PLIMESH1"
inline constexpr std::uint64_t message_end = 0x2e'44'4e'45'48'53'45'4d;    // "MESHEND."
inline constexpr std::uint32_t no_object = 0xffff'ffff;
inline constexpr std::uint32_t most_objects = 1'000'000;

enum class MessageKind : std::uint32_t {
  Scene = 0,
  Refused = 1,      ///< the file is broken; with the reason
  OtherFormat = 2,  ///< it does not have the format of its ending
  TooManyObjects = 3
};

/// Numbers at any alignment within a message, which must outlive them.
template <class T>
class PackedNumbers {
 public:
  PackedNumbers() = default;
  explicit PackedNumbers(std::string_view bytes) : bytes_(bytes) {}

  std::size_t size() const { return bytes_.size() / sizeof(T); }
  bool empty() const { return bytes_.empty(); }
  T operator[](std::size_t k) const {
    T number;
    std::memcpy(&number, bytes_.data() + k * sizeof(T), sizeof(T));
    return number;
  }

 private:
  std::string_view bytes_;
};

/// Faces of one material. Sizes are consistent with each other; indices are those of the file.
struct Submesh {
  std::string_view material;
  std::uint32_t uv_sets = 0;             ///< bit k: there is a set k
  PackedNumbers<float> positions;        ///< x, y and z of each vertex
  PackedNumbers<float> normals;          ///< likewise, or empty
  PackedNumbers<float> uvs;              ///< of the requested set: u and v, or empty
  PackedNumbers<std::uint32_t> sizes;    ///< #faces: corners of each
  PackedNumbers<std::uint32_t> corners;  ///< #corners: a vertex of this submesh
};

struct ObjectEntry {
  std::string_view node;
  std::string_view mesh;       ///< of the first mesh with faces
  std::uint64_t vertices = 0;  ///< of its submeshes
  std::uint64_t faces = 0;     ///< likewise
  std::uint64_t left_out = 0;  ///< faces of its meshes with fewer than three corners
};

struct MeshMessage {
  MessageKind kind = MessageKind::Scene;
  std::string_view reason;            ///< of Refused
  std::vector<ObjectEntry> objects;   ///< in the order of the file
  std::optional<std::size_t> chosen;  ///< the object of these submeshes
  Eigen::Matrix4d to_file = Eigen::Matrix4d::Identity();
  std::vector<Submesh> submeshes;
};

/// Parses bytes that a broken or hostile process may have written; they must outlive the result.
/// nullopt if they are not exactly one complete message with consistent numbers. Needs no more
/// memory than a few times the size of the bytes. The mesh itself may still be wrong.
std::optional<MeshMessage> parse_mesh_message(std::string_view bytes);

}  // namespace pliant
