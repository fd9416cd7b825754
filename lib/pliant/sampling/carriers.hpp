#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/core/transform.hpp"

namespace pliant {

class AnimatedShape;
class CarrierTriangles;
struct RestShape;
struct Scene;

/// A place that a surface carries, in the world at a frame, and what turns with it.
struct Carried {
  Vector3d place;       ///< [length]
  Matrix3d directions;  ///< takes directions of the surface's object space to the world
  Matrix3d rotation;    ///< of the pattern of a noise
};

/// The surfaces that forces and groups of a scene follow. A surface carries by its transform; one
/// with a cache also by the triangle of its rest shape that is nearest to the place at the scene's
/// start. Never by its displacement. Thread-safe. docs/model.md, "Forces".
class Carriers {
 public:
  /// They carry by their transforms only.
  explicit Carriers(const Scene& scene);

  /// `shapes`: of all surfaces, in their order. Null: nothing is followed. Errors: those of
  /// `AnimatedShape`; no triangle of a surface that is followed has an area; Interrupted.
  static Result<std::shared_ptr<const Carriers>> make(
      const Scene& scene, std::span<const std::reference_wrapper<const RestShape>> shapes,
      const StopRequest& should_stop = {});

  /// A place in the object space of a surface that is followed. Errors: those of `AnimatedShape`;
  /// the triangle that carries it has no area at the frame.
  Result<Carried> carry(const Scene& scene, std::string_view surface, const Vector3d& place,
                        int frame) const;

 private:
  struct Carrier {
    std::size_t surface;                                     // its index in the scene
    std::shared_ptr<const CarrierTriangles> triangles = {};  // null: it has no cache
  };

  std::map<std::string, Carrier, std::less<>> carriers_;
};

}  // namespace pliant
