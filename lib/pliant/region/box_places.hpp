#pragma once

#include <memory>
#include <vector>

#include "pliant/core/grid.hpp"

namespace pliant {

/// Numbered boxes of a grid that may be closed, in a tree, so that few are looked at to find those
/// that another one meets. Internal to region.
class BoxPlaces {
 public:
  explicit BoxPlaces(const Grid& grid);
  BoxPlaces(const BoxPlaces&) = delete;
  BoxPlaces& operator=(const BoxPlaces&) = delete;
  ~BoxPlaces();

  /// Requires: it is not empty.
  void insert(const Box& box, int number);

  /// Requires: it was inserted so.
  void remove(const Box& box, int number);

  /// The numbers of the boxes that share a node with this one, ascending.
  std::vector<int> meeting(const Box& box) const;

 private:
  struct Tree;

  Grid grid_;
  std::unique_ptr<Tree> tree_;
};

}  // namespace pliant
