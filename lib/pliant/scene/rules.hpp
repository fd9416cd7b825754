#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/scene/element.hpp"
#include "pliant/scene/scene_file.hpp"

namespace pliant::xml {

// Rules between values that are each valid alone. A rule is not checked if one of its values is
// unreadable, animated (`check_channels` checks those frame by frame), or already rejected. A value
// that breaks a rule is marked as not sound.

/// end >= start, and at most 10^6 frames. SCENE FORMAT, scene.
void check_frames(const Scene& scene, std::span<Slot> table, Findings& findings);

/// A grid of at most 10^8 vertices.
void check_nodes(const GridSheet& grid, std::span<Slot> table, int line, Findings& findings);

/// c > -2 sqrt(b d). SPEC 2.
void check_well_posed(const MaterialChannels& material, std::span<Slot> table, Findings& findings);

/// At most 10^5 steps a frame. SPEC 2, 4. `line` is reported if dt is not given.
void check_steps(const SolverSettings& solver, std::span<Slot> table, double fps, int line,
                 Findings& findings);

/// A surface, a force or a group that has a name.
struct Named {
  std::string_view element;
  std::string name;
  int line = 0;
};

/// Names are unique.
void check_unique(std::span<const Named> named, Findings& findings);

/// `targets` name surfaces. `named` contains all named children of the scene, also those that could
/// not be read: their problems are reported elsewhere.
void check_targets(const Scene& scene, std::span<const Targets> targets,
                   std::span<const Named> named, Findings& findings);

/// A force in a group may have fewer targets than the group; other targets have no effect.
void note_idle_targets(const Scene& scene, Findings& findings);

/// Also checks what a run would reject, so that all problems of a file are reported at once:
/// channels that break their rule at a frame, and mesh files that cannot be opened. Only sound
/// values are checked.
void check_further(const Scene& scene, std::span<const Named> named, SceneFile& file);

}  // namespace pliant::xml
