#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "pliant/simulation/simulation.hpp"
#include "viewer/arrays.hpp"
#include "viewer/coarse_mesh.hpp"
#include "viewer/json.hpp"
#include "viewer/motion.hpp"

namespace pliant::viewer {

/// The vertices of all takes together that a page has, and those of one; more would make it slow,
/// and are not seen in pictures of their size.
inline constexpr int most_shown_vertices = 600'000, most_vertices_of_take = 15'000;

/// Takes of a sweep, each at one frame, packed for a page. All surfaces of a take are one mesh.
/// Thread-safe.
class TakeShapes {
 public:
  /// A mesh of more than `most_vertices` is made coarser. Requires: most_vertices >= 8.
  explicit TakeShapes(int most_vertices) : most_vertices_(most_vertices) {}

  /// Packs a take; one that comes again takes the place of the first. Errors: NotFinite if a
  /// coordinate is outside the range of float.
  Result<void> add(std::size_t take, const Simulation& simulation, const Frame& frame);

  void remove(std::size_t take) { shapes_.erase(take); }

  /// An object with all takes, in their order, and the meshes that they share; docs/viewer.md.
  Json finish(Arrays& arrays) const;

 private:
  struct Shape {
    int frame = 0;
    int vertex_count = 0;                       // of the mesh as it is
    double most_displaced = 0;                  // of all its vertices [length]
    std::string mesh = {};                      // its hash
    std::size_t shown = 0;                      // vertices
    Vector3d origin = {}, low = {}, high = {};  // world
    PackedMotion motion = {};                   // one frame: positions less the origin
    std::string displaced_low = {}, displaced_high = {};
  };

  std::shared_ptr<const CoarseMesh> coarse(const Field& positions,
                                           const std::vector<std::uint32_t>& triangles);

  int most_vertices_;
  std::mutex mutex_;                           // guards the others
  std::map<std::size_t, Shape> shapes_;        // by take
  std::map<std::string, std::string> meshes_;  // differences of their triangles, by hash
  std::map<std::string, std::shared_ptr<const CoarseMesh>> coarse_;  // by the hash of the fine one
};

}  // namespace pliant::viewer
