#pragma once

#include <string>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// Writes a scene to a file, and beside it what is in memory, exact. With STEM the file's name
/// without its ending, and NAME that of the surface or collider:
/// - a `Mesh` to STEM.NAME.obj, or to STEM.NAME.ply if its attributes are read or an .obj cannot
///   keep it;
/// - values at the nodes of a sheet or net to STEM.NAME.CHANNEL.npy, of a hold to
///   STEM.NAME.hold.0.npy, counted from 0;
/// - values at the vertices of a mesh to attributes of its .ply, which is made of a mesh in a file
///   too, named `CHANNEL` or `hold.0`, with `_2`, `_3`, … where the mesh has such an attribute;
/// - samples of a moving shape to STEM.NAME.cache.npy.
///
/// All other files that the scene names are written relative to the file's folder. `load_scene`
/// reads the same scene, but for what became files, and it moves with the same bits.
///
/// All files appear whole or not at all, the scene's last: after an error all are as they were.
/// They replace files with their names, but none that the saved scene still reads as something
/// else. Files of an earlier save that are not needed any more stay.
///
/// Errors: those of `to_xml`, for what no file contains, but for what is written beside it;
/// InvalidInput for a mesh that neither format keeps (`write_mesh`), for values or samples that
/// could not be read again, and for a file that the scene reads; those of reading a mesh whose
/// vertices get values; those of `check_output_place`; Unwritable; Interrupted.
Result<void> save_scene(const Scene& scene, const std::string& file,
                        const StopRequest& should_stop = {});

}  // namespace pliant
