#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/document/operation.hpp"

namespace pliant {

// Operations as JSON: `{"op":"setKey","channel":"poke.magnitude","frame":12,"value":"8000"}`. All
// names and values are made from the rows of operation_rows.hpp.

/// The format of a member of an operation, or of an object in one.
struct MemberFormat {
  std::string_view name;  ///< of a member in operation.hpp, in camelCase; `curve` are its `keys`
  /// "text", "number", "integer", "boolean", "word", one of `words`, "texts", "numbers", "curve", a
  /// text, or "objects", each with `members`.
  std::string_view type;
  std::string_view meaning;  ///< for people, in Markdown
  std::string_view unit = {};
  std::string range = {};  ///< of a number; empty: any
  std::span<const std::string_view> words = {};
  bool is_required = false;
  /// The default as JSON; in parentheses: what its absence means; empty: it is required.
  std::string standard = {};
  std::vector<MemberFormat> members = {};
};

/// The format of an operation.
struct OperationFormat {
  std::string_view name;     ///< its `op`
  std::string_view meaning;  ///< for people, in Markdown
  std::vector<MemberFormat> members;
};

/// The formats of all operations, in the order of `Operation`: what another language may make its
/// own of.
const std::vector<OperationFormat>& operation_formats();

/// A list of operations as JSON, without the members that have their defaults. Errors: what JSON
/// cannot say: a number that is not finite, a text that is not UTF-8; keys that are no curve.
Result<std::string> to_json(const std::vector<Operation>& operations);

/// Reads a list of operations from JSON that anybody may have written. Errors: the first problem,
/// with the operation, the member, its value and the rule: those of JSON itself; an operation or a
/// member that is unknown; a required member that is missing; a value of another type, or out of
/// its range; a `curve` that is no `<animate>`, breaks a rule, or has a `$`, and loops that
/// together make more than 10^6 copies of keys. Interrupted.
Result<std::vector<Operation>> parse_operations(std::string_view json,
                                                const StopRequest& should_stop = {});

}  // namespace pliant
