#pragma once

#include <vector>

#include "pliant/core/field.hpp"

namespace pliant {

/// A half-space of the world that an unknown of a plate is kept in. With d the way in the world
/// that contact moves it from where the step without contact ends, normal . d >= lift.
/// docs/model.md, "Contact".
struct ContactRow {
  int unknown = 0;
  Vector3d normal = {0, 1, 0};  ///< of length 1
  double lift = 0;              ///< > 0: the step without contact violates it [length]
  bool lies = false;            ///< whether the unknown was close to it when the step began
  bool rests = false;           ///< and as close as one that was pushed
  bool sticks = false;          ///< then d is -slip across the normal, and lift along it
  double friction = 0;          ///< mu >= 0
  Vector3d slip = {0, 0, 0};    ///< from where it touched to the end of the step without contact
  Vector3d place = {0, 0, 0};   ///< where it touched; no force depends on it [length]
  int collider = 0;             ///< rows of one unknown and collider are one from solve to solve
};

/// What a plate meets in its steps. Fields have the unknowns that move (#moving x 3).
class StepContact {
 public:
  StepContact() = default;
  StepContact(const StepContact&) = delete;
  StepContact& operator=(const StepContact&) = delete;
  virtual ~StepContact() = default;

  /// A step, counted from 0 in its interval, that goes `from` displacements `to` others without
  /// contact: whether something touches on the way. Then there are rows.
  virtual bool begin(int step, const Field& from, const Field& to) = 0;

  /// The same step ends elsewhere: whether more touches on that way. Then the rows have changed.
  virtual bool join(const Field& to) = 0;

  /// Without contact the step would end elsewhere than `begin` was told: rows are from there now.
  virtual void end_freely_at(const Field& to) = 0;

  /// By unknowns, ascending, and in the order in which they joined.
  virtual const std::vector<ContactRow>& rows() const = 0;

  /// The forces of the rows in the world, once a step is solved. None: nothing touched.
  virtual void end(const std::vector<Vector3d>& forces) = 0;

  virtual double tolerance() const = 0;  ///< of what a row lacks [length]

  /// Take vectors of the world to those of the plate at the end of the step, and back.
  virtual Matrix3d to_plate() const { return Matrix3d::Identity(); }
  virtual Matrix3d to_world() const { return Matrix3d::Identity(); }
};

}  // namespace pliant
