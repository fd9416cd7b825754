#pragma once

#include <string>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// The scene as a scene file: read again, it is the same scene to the bit. Attributes with their
/// default values are left out. Mesh files are written relative to `folder`; empty: as they are.
///
/// Errors: InvalidInput for what breaks a rule of the format, naming it, for what a file cannot
/// contain, a `Mesh`, values and samples of a program, a `CustomForce` and a falloff curve that is
/// not a <falloff>, and for a group whose forces are not one after the other in the scene, or come
/// before those of an earlier group. Also for a text that could not be read again: too large, or
/// with characters that XML does not have in the name of a file. Interrupted.
Result<std::string> to_xml(const Scene& scene, const std::string& folder = {},
                           const StopRequest& should_stop = {});

}  // namespace pliant
