#pragma once

#include <string>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/document/document.hpp"

namespace pliant {

/// What a document's scene says of each attribute, as JSON, made from the description of the
/// format: what a panel of a program shows, and what it may put into an `edit::Set`.
///
///     [{"name": "poke", "kind": "point", "group": "pair", "file": "rig.xml", "lines": [5, 9],
///       "attributes": [{"name": "magnitude", "element": "point", "path": "poke.magnitude",
///         "value": "8000", "written": "2 * $push", "given": true, "components": 1,
///         "animated": false, "excluded": …, "file": …}, …]}, …]
///
/// The first object is the scene itself, named `scene`; the surfaces, forces, groups and colliders
/// follow in the order of the text, where each included file stands at its <include>. `kind` is the
/// element of an object, `shape` that of its shape, and `lines` are the first and last one of its
/// element.
///
/// `element` is that in which an attribute stands, also if the text does not have it yet. `value`
/// is the constant, or the default if there is none, as an `edit::Set` takes it; empty: it is
/// animated, or nothing. Numbers stand in it as they are written. `written` is the text of a value
/// that is made of definitions. `given`: the text has the attribute, or animates it. `components`
/// are the numbers of a key; 0: it has no keys. `animated`: by an <animate>, a <path>, or a
/// <falloff>. `excluded` says why it must not be given there. `file` is the one in which an object,
/// or the element of an attribute, stands, as seen from the document's folder, if that is not the
/// document's own: it cannot be changed here. `shape`, `group`, `file`, `written` and `excluded`
/// are absent if they do not apply. Left out are names, and what no path leads to, such as a
/// <hold>.
///
/// Cost: one scan of the text. Errors: Interrupted.
Result<std::string> properties_json(const SceneDocument& document,
                                    const StopRequest& should_stop = {});

}  // namespace pliant
