#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/files/boxed/read_assimp.hpp"

namespace pliant::gltf {

// The parts of a glTF 2 file's JSON that describe meshes and animations, as plain values. Every
// index into one of the document's lists is in range. Sizes and offsets are as written; code that
// uses them to read bytes must check them. Internal to the library.

struct Buffer {
  std::uint64_t size = 0;  ///< [bytes]
  std::optional<std::string> uri = {};
};

struct BufferView {
  std::size_t buffer = 0;
  std::uint64_t offset = 0;
  std::uint64_t size = 0;
  std::uint64_t stride = 0;  ///< from one element to the next; 0: tightly packed. [bytes]
};

/// Elements that replace some of an accessor's.
struct Sparse {
  std::uint64_t count = 0;
  std::size_t index_view = 0;
  std::uint64_t index_offset = 0;
  std::uint64_t index_type = 0;  ///< a `componentType`
  std::size_t value_view = 0;
  std::uint64_t value_offset = 0;
};

struct Accessor {
  std::optional<std::size_t> view = {};  ///< nullopt: all elements are zeros
  std::uint64_t offset = 0;
  std::uint64_t component_type = 0;
  bool is_normalized = false;
  std::uint64_t count = 0;
  std::string type = {};  ///< SCALAR, VEC2, …
  std::optional<Sparse> sparse = {};
};

struct Primitive {
  std::uint64_t mode = 4;
  std::optional<std::size_t> positions = {};
  std::optional<std::size_t> normals = {};
  std::array<std::optional<std::size_t>, max_uv_sets> uvs = {};
  /// Those of the author's own, such as `_SOFT`: name and accessor.
  std::vector<std::pair<std::string, std::size_t>> customs = {};
  std::optional<std::size_t> indices = {};
  std::optional<std::size_t> material = {};
};

struct MeshEntry {
  std::string name;  ///< `meshes[3]` if the file has no name
  std::vector<Primitive> primitives = {};
};

struct Node {
  std::string name;  ///< `nodes[3]` if the file has no name
  Eigen::Matrix4d to_parent = Eigen::Matrix4d::Identity();
  std::optional<std::size_t> mesh = {};
  std::vector<std::size_t> children = {};
};

/// How the values of an animation are found between its keys.
enum class KeyedInterpolation { Step, Linear, CubicSpline };

struct AnimationSampler {
  std::size_t times = 0;   ///< an accessor
  std::size_t values = 0;  ///< an accessor
  KeyedInterpolation interpolation = KeyedInterpolation::Linear;
};

struct AnimationChannel {
  std::size_t sampler = 0;
  std::optional<std::size_t> node = {};  ///< nullopt: an extension says what it animates
  std::string path = {};                 ///< translation, rotation, scale, weights, …
};

struct Animation {
  std::string name;  ///< `animations[3]` if the file has no name
  std::vector<AnimationSampler> samplers = {};
  std::vector<AnimationChannel> channels = {};
  std::optional<double> first_frame = {};  ///< extras.pliantFirstFrame
};

struct Document {
  std::vector<Buffer> buffers;
  std::vector<BufferView> views;
  std::vector<Accessor> accessors;
  std::vector<MeshEntry> meshes;
  std::vector<std::string> materials;  ///< their names, possibly empty
  std::vector<Node> nodes;
  std::vector<std::size_t> roots;     ///< root nodes of the scene that the file displays, as listed
  std::vector<std::string> looks;     ///< required extensions that concern looks only
  std::vector<Animation> animations;  ///< only if they were asked for
};

/// What is wanted of a file.
enum class Subject { Meshes, Animations };

/// Limit of the number of files that a glTF refers to; json_reader.hpp has those of its JSON.
inline constexpr std::size_t most_buffers = 1000;

/// The longest name of a node, mesh or animation: many nodes may share that of a mesh. [bytes]
inline constexpr std::size_t longest_name = 1024;

/// Errors: invalid JSON, with the line, but without quoting the text, which may be of any file; not
/// glTF 2; a required extension that is not supported, by name; a member of the wrong type or out
/// of range, by its path; Interrupted. Without a scene its roots are all nodes that are no
/// children.
Result<Document> read_document(std::string_view json, Subject subject = Subject::Meshes,
                               const StopRequest& should_stop = {});

}  // namespace pliant::gltf
