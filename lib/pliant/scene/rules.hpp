#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/scene/element.hpp"
#include "pliant/scene/scene_file.hpp"

namespace pliant::xml {

// Rules between values that are each right by themselves. A rule is not checked where one of its
// values was not readable, is animated (`check_channels` checks those frame by frame), or is
// refused already; a value that breaks one is no longer sound.

/// end >= start, and at most 10^6 frames. SCENE FORMAT, scene.
void check_frames(const Scene& scene, std::span<Attribute> table, Findings& findings);

/// A grid of at most 10^8 vertices.
void check_nodes(const GridSheet& grid, std::span<Attribute> table, int line, Findings& findings);

/// c > -2 sqrt(b d). SPEC 2.
void check_well_posed(const MaterialChannels& material, std::span<Attribute> table,
                      Findings& findings);

/// At most 10^5 steps a frame. SPEC 2, 4. `line` stands in where dt is not written.
void check_steps(const SolverSettings& solver, std::span<Attribute> table, double fps, int line,
                 Findings& findings);

/// A surface, a force or a group that has a name.
struct Named {
  std::string_view element;
  std::string name;
  int line = 0;
};

/// Names are unique.
void check_unique(std::span<const Named> named, Findings& findings);

/// `targets` name surfaces. `named` are all named children of the scene, also those that could not
/// be read: what is wrong with them is told elsewhere.
void check_targets(const Scene& scene, std::span<const Targets> targets,
                   std::span<const Named> named, Findings& findings);

/// What a run would refuse besides, so that a file with problems tells all of them at once:
/// channels that break their rule at a frame, mesh files that cannot be opened. Looks only at what
/// is sound.
void check_further(const Scene& scene, std::span<const Named> named, SceneFile& file);

}  // namespace pliant::xml
