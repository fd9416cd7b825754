#pragma once

#include <string>

namespace pliant {

/// The scene format as JSON, made from its description: what a panel of a program needs of each
/// element and attribute.
///
///     {"elements": [{"name": "point", "meaning": …, "parents": ["scene", …], "mayInclude": false,
///       "attributes": [{"name": "magnitude", "type": "number", "meaning": …, "keyable": true,
///         "required": false, "unit": …, "range": "> 0", "least": 0, "excludesLeast": true,
///         "default": "1", "words": […], "position": true, "surfaces": true}, …],
///       "children": [{"names": […], "least": 0, "part": false, "most": 1, "noun": …}, …],
///       "text": {"meaning": …}}, …]}
///
/// The first element is the root. All are in the order of docs/scene-format.md and have its texts.
/// A `default` in parentheses is what the absence means. `least`, `most`, `excludesLeast` and
/// `excludesZero` say the range of numbers; `most` of a child is absent if there may be any number.
/// `words` are those that a value may have, or begin with; those of `attribute` in an <animate> are
/// the channels of what it stands in. A <path> may move a `position`, `surfaces` are named, one or
/// some, and the attributes of a `part` count as those of the element around it. What does not
/// apply is absent.
std::string scene_format_json();

}  // namespace pliant
