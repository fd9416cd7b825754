#pragma once

#include <string>

namespace pliant {

/// The format as an XML schema (XSD 1.0), for editors: docs/pliant-scene.xsd. Made from
/// `scene_format`. What the reader accepts it accepts too; docs/scene-format.md, "Schema", lists
/// the rules that it cannot say.
std::string scene_schema();

}  // namespace pliant
