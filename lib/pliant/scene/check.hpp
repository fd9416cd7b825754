#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// The most frames that a scene may have.
inline constexpr int max_frames = 1'000'000;

/// How far from 0 a frame of a scene may lie.
inline constexpr int largest_frame = 1'000'000'000;

/// The most vertices that a grid sheet may have.
inline constexpr int max_sheet_vertices = 100'000'000;

/// The largest width or depth of a grid sheet [length]; coordinates times counts stay finite.
inline constexpr double largest_extent = 1e300;

/// Whether a name matches [A-Za-z_][A-Za-z0-9_-]*.
bool is_name(std::string_view text);

/// What must hold of a scene as a whole, read or built in code: fps > 0; start <= end, within
/// `largest_frame`, at most `max_frames` frames; names well formed and unique over surfaces,
/// forces and groups; targets and groups that exist; a custom force that has a function; sheets of
/// at least 3 x 3 and at most `max_sheet_vertices` vertices, with positive extents. Channels are
/// checked over the frames by `Simulation::make`. Every problem found, with its line if known.
std::vector<Error> check_scene(const Scene& scene);

/// Whether a mesh file is there, may be read, and is a regular file: a pipe or a device might never
/// end. Errors: Unreadable.
Result<void> check_mesh_file(const std::filesystem::path& file);

/// A mesh file that cannot be read is the scene's mistake: the reader's error (Unreadable) as that
/// of the surface, at the line where the file is named.
Error unreadable_mesh(const Error& error, const std::string& surface, const SceneOrigin& origin);

}  // namespace pliant
