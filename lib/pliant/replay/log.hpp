#pragma once

#include <string>
#include <vector>

#include "pliant/body/state.hpp"
#include "pliant/core/hash.hpp"

namespace pliant {

// The content of a .replay file (docs/replay.md), as values.

/// One surface at the output of a frame. SPEC 6, 10.
struct SurfaceDigest {
  Hash positions;   ///< of the nodes, object space
  Hash velocities;  ///< of the nodes, as the next frame uses them
  Hash region;      ///< of the input of the frame's solve; docs/replay.md
  double peak = 0;  ///< largest distance of a node from rest, object space [length]

  friend bool operator==(const SurfaceDigest&, const SurfaceDigest&) = default;
};

/// All surfaces at one frame, in the order of the scene.
struct ReplayFrame {
  int number = 0;
  std::vector<SurfaceDigest> surfaces;
  std::vector<BodyState> states = {};  ///< empty, or one per surface; without `unsettled`
};

/// A file that the scene names, such as a mesh.
struct ReplayFile {
  std::string name;  ///< relative to the scene's folder, if there is such a path
  Hash hash;         ///< of its bytes

  friend bool operator==(const ReplayFile&, const ReplayFile&) = default;
};

/// A surface that was simulated.
struct ReplaySurface {
  std::string name;
  int columns = 0;  ///< of its grid; 0: a surface of triangles
  int rows = 0;
  int nodes = 0;  ///< of a surface of triangles

  int node_count() const { return columns == 0 ? nodes : columns * rows; }

  friend bool operator==(const ReplaySurface&, const ReplaySurface&) = default;
};

/// A description of the run that was recorded.
struct ReplayHeader {
  std::string version;     ///< of pliant
  std::string scene_file;  ///< relative to the log's folder, if there is such a path
  std::string scene_text;
  std::vector<std::string> changes = {};  ///< made in the scene, as typed after --set
  std::vector<ReplayFile> files;
  std::string solver;   ///< a name that `solver_choice` accepts
  std::string factors;  ///< the solver for sparse factors, as returned by `name_of`
  int start = 0;        ///< first frame
  int end = 0;          ///< last frame, >= start
  std::vector<ReplaySurface> surfaces;

  long frame_count() const { return long{end} - start + 1; }

  friend bool operator==(const ReplayHeader&, const ReplayHeader&) = default;
};

/// The version of the log's format for writing, and the only one that can be read.
inline constexpr int replay_format = 1;

}  // namespace pliant
