#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/transform.hpp"

namespace pliant {

/// One surface at one frame. Owns its data: it may outlive the simulation.
class SurfaceFrame {
 public:
  SurfaceFrame() = default;
  SurfaceFrame(std::string name, Field object_positions, const Transform& transform,
               double peak_displacement);

  const std::string& name() const { return name_; }

  /// #vertices x 3 in the order of the mesh, world space [length]. Computed from the object-space
  /// positions at each call; reuses the memory of `reuse`.
  Field positions(Field reuse = {}) const;

  /// #vertices x 3 in the order of the mesh, object space [length].
  const Field& object_positions() const { return object_positions_; }

  /// The vertices at rest at this frame, likewise, of a shape that is animated; of others it is
  /// empty, as they have their mesh.
  const Field& object_rest() const { return object_rest_; }

  const Transform& transform() const { return transform_; }  ///< object to world, at this frame

  /// The largest distance of a vertex from its rest position, in world space. [length]
  double peak_displacement() const { return peak_displacement_; }

  /// The same as people are to be told it: 0 if it is no more than rounding, less than 1e-12 of the
  /// surface's size. [length]
  double told_displacement() const;

 private:
  friend class Bodies;  // refills it

  std::string name_;
  Field object_positions_;
  Field object_rest_;
  Transform transform_;
  double peak_displacement_ = 0;
};

/// All surfaces at one frame.
class Frame {
 public:
  Frame() = default;
  Frame(int number, std::vector<SurfaceFrame> surfaces);

  int number() const { return number_; }

  /// In the order of the scene.
  std::span<const SurfaceFrame> surfaces() const;

  /// The surface of that name, or null: for names from input data.
  const SurfaceFrame* find_surface(std::string_view name) const;

  /// The surface of that name. Requires: it exists.
  const SurfaceFrame& surface(std::string_view name) const;

  /// A message about a name that no surface has: the name, the nearest name and all names.
  std::string no_surface_text(std::string_view name) const;

 private:
  friend class Bodies;

  int number_ = 0;
  std::vector<SurfaceFrame> surfaces_;
};

}  // namespace pliant
