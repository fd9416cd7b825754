#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pliant/body/body.hpp"
#include "pliant/feedback/warning_log.hpp"
#include "pliant/sampling/rest_shape.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// Looks at the states of a run after each step, for warnings about how the surfaces move. It reads
/// each node's displacement once or twice a step, and changes nothing.
class RunWatch {
 public:
  RunWatch() = default;

  /// The surfaces and their shapes, in one order.
  RunWatch(const Scene& scene, std::span<const RestShape> shapes);

  /// Whether it needs the velocities from before a step of a surface.
  bool needs_velocities(std::size_t surface) const { return surfaces_[surface].freezes; }

  /// A step of a surface at a frame. `before`: #nodes x 3, the velocities from before the step;
  /// read only if it `needs_velocities`. `frame_length`: [s].
  void look(std::size_t surface, int frame, double frame_length, bool is_solved, const Body& body,
            const Field& before, WarningLog& log);

  /// The next step of a surface does not follow the last one.
  void forget_step(std::size_t surface) { surfaces_[surface].was_solved = false; }

  /// Whether a step looked at left any node away from rest.
  bool has_moved(std::size_t surface) const { return surfaces_[surface].has_moved; }

 private:
  struct Watched {
    std::string_view name;
    std::vector<int> loose = {};        // as of `loose_pieces_of`; empty: all is held
    std::vector<int> node_counts = {};  // of loose pieces
    std::vector<Vector3d> sums = {};    // of their displacements; room
    double diagonal = 0;                // of the box around its nodes
    bool freezes = false;
    bool was_solved = false;
    bool has_moved = false;
    double peak = 0;  // the largest displacement so far
  };

  static bool flies_away(Watched& one, const Body& body);
  static bool freezes(const Watched& one, double frame_length, bool is_solved, const Body& body,
                      const Field& before);

  std::vector<Watched> surfaces_;
};

}  // namespace pliant
