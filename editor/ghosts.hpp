#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "editor/frame_solver.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant::editor {

/// A take that is played while the document goes on.
struct Ghost {
  static constexpr Revision revision = 1;  ///< of what its solver plays

  std::int64_t take = 0;
  FrameSpan frames = {};
  std::chrono::steady_clock::time_point asked = {};  ///< the last time
  std::unique_ptr<FrameSolver> solver = {};
};

/// The takes that pages look at. Each has a solver of its own, on one thread and after the
/// document's. Used by one thread.
class Ghosts {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t most = 2;

  /// `present`: the solver of the document, which outlives this; it lends its memory.
  Ghosts(FrameSolver& present, SimulationOptions simulation);

  /// That of a take, which somebody asks for now; null: it is not played.
  const Ghost* find(std::int64_t take);
  /// Plays it, if there are too many in place of the one that was not asked for longest.
  const Ghost& begin(std::int64_t take, Scene scene);
  void end(std::int64_t take);
  void end_all();
  /// Ends those that nobody has asked for lately.
  void end_idle(Clock::time_point now);

  std::size_t count() const { return ghosts_.size(); }
  /// The arrays of a shape of one of them; null: there is none.
  std::shared_ptr<const std::string> shape(const std::string& key) const;

 private:
  template <class Ends>
  void end_if(const Ends& ends);

  FrameSolver& present_;
  SimulationOptions simulation_;
  std::vector<Ghost> ghosts_;
};

}  // namespace pliant::editor
