#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

#include <nlohmann/json.hpp>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant {

// The binary buffer of a glTF file, which is written as its numbers arrive, and the JSON that
// describes it. glTF 2.0, 3.6. Internal to output.
class GltfBuffer {
 public:
  using Json = nlohmann::ordered_json;
  using Sink = std::function<Result<void>(std::string_view)>;

  enum class Bounds { None, Written };

  explicit GltfBuffer(Sink sink, StopRequest should_stop = {})
      : sink_(std::move(sink)), should_stop_(std::move(should_stop)) {}

  // Each function adds an accessor and returns its index. Errors: those of the sink; Interrupted.

  /// Rows of `width` floats for each vertex; with the least and the largest of each component.
  Result<std::size_t> add_vertices(std::span<const float> numbers, int width, Bounds bounds);

  /// Rows of three floats for each vertex, many of which may be 0: stored sparsely if that is
  /// smaller. Requires: numbers is not empty.
  Result<std::size_t> add_offsets(std::span<const float> numbers, Bounds bounds);

  /// Corner indices of triangles.
  Result<std::size_t> add_indices(std::span<const std::uint32_t> indices);

  /// Times of keys, and their values in rows of `width`: the numbers of an animation.
  Result<std::size_t> add_keys(std::span<const float> numbers, int width, Bounds bounds);

  /// One number per key and target: 1 for the target of that key, otherwise 0. `target_of_key` is
  /// -1 for keys without a target. Written row by row.
  Result<std::size_t> add_weights(std::span<const int> target_of_key, int target_count);

  std::uint64_t size() const { return size_; }  ///< bytes written so far

  const Json& views() const { return views_; }
  const Json& accessors() const { return accessors_; }

 private:
  Result<void> write(std::string_view bytes);
  Result<std::size_t> add_view(std::string_view bytes, int target);
  std::size_t add_accessor(Json accessor);
  Result<std::size_t> add_rows(std::span<const float> numbers, int width, Bounds bounds,
                               int target);

  Sink sink_;
  StopRequest should_stop_;
  std::uint64_t size_ = 0;
  Json views_ = Json::array();
  Json accessors_ = Json::array();
};

}  // namespace pliant
