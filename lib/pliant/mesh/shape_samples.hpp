#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "pliant/core/field.hpp"

namespace pliant {

/// The positions of a mesh's vertices at some times, as a program gives them. An immutable value,
/// safe to share between threads.
class ShapeSamples {
 public:
  ShapeSamples() = default;  ///< none

  /// Samples in the order of their times, each #vertices x 3 [length]. Copies share them: of
  /// constant cost.
  explicit ShapeSamples(std::vector<Field> samples);

  bool is_empty() const { return samples_ == nullptr; }
  std::size_t count() const { return samples_ ? samples_->size() : 0; }
  std::size_t bytes() const;  ///< that they take, however many copies share them [bytes]

  /// Requires: number < count().
  const Field& operator[](std::size_t number) const { return (*samples_)[number]; }

  /// The same numbers, or a copy.
  friend bool operator==(const ShapeSamples& a, const ShapeSamples& b);

 private:
  std::shared_ptr<const std::vector<Field>> samples_;  // null: none
};

}  // namespace pliant
