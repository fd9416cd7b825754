#pragma once

#include <string>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant {

/// The text of a scene file in its canonical layout: an element a line, indented by two blanks;
/// tags of at most 100 columns, if they can be broken; double quotes; at most one blank line
/// between elements; the line ends of the first line. Attributes keep their order and values their
/// characters. Comments stay, those behind something on its line there. The scene is the same to
/// the bit, and a text that was laid out stays as it is. `name`: the file in messages. Errors:
/// those of `markup_of`, also for the layout; the caller has read the scene.
Result<std::string> format_scene(const std::string& text, const std::string& name,
                                 const StopRequest& should_stop = {});

}  // namespace pliant
