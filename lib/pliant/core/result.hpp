#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

namespace pliant {

/// The kind of an `Error`; the command derives its exit code from it.
enum class ErrorCode {
  InvalidInput,  ///< a scene, mesh or argument breaks a documented rule
  Unreadable,    ///< a file could not be opened or read
  Unwritable,    ///< a file could not be created, written or renamed
  OutOfMemory,   ///< the work does not fit in memory
  SolverFailed,  ///< a linear system could not be factored or solved
  NotFinite,     ///< a state stopped being finite
  Interrupted,   ///< the caller asked to stop
};

/// A stretch of a text up to, but not including, its end. All count from 1; columns count UTF-16
/// code units, as editors do. 0: unknown.
struct TextSpan {
  int line = 0;
  int column = 0;
  int end_line = 0;
  int end_column = 0;

  friend bool operator==(const TextSpan&, const TextSpan&) = default;
};

/// One problem: its message and place. `others` contains further problems found in the same run, in
/// the order in which they were found; their own `others` are empty.
struct Error {
  ErrorCode code = ErrorCode::InvalidInput;
  std::string message;    ///< one line: the thing, the value, the rule
  std::string file = {};  ///< empty: not about a file
  int line = 0;           ///< of `TextSpan`, as the others
  int column = 0;
  int end_line = 0;
  int end_column = 0;
  std::vector<Error> others = {};

  TextSpan span() const { return {line, column, end_line, end_column}; }
};

/// Why a value cannot be used. It knows of no file: words that follow what names the value, such as
/// `<grid> width="1,5": `.
struct Complaint {
  enum class Kind {
    Value,
    Syntax,       ///< the text may not be meant as such a value
    Interrupted,  ///< the caller asked to stop; nothing is wrong
  };

  std::size_t index = 0;  ///< of the part that is wrong: a key, a waypoint
  std::string message;    ///< one line: the value, the rule
  Kind kind = Kind::Value;
  std::string part = {};  ///< the attribute that is wrong, as the scene format calls it
};

/// A value, or the error that explains why there is none: a `tl::expected` that must not be
/// discarded.
template <class T, class E = Error>
class [[nodiscard]] Result : public tl::expected<T, E> {
 public:
  using tl::expected<T, E>::expected;
  Result() = default;
  Result(tl::expected<T, E> result) : tl::expected<T, E>(std::move(result)) {}
};

/// A value, or what is wrong with what it was to be made of.
template <class T>
using Checked = Result<T, Complaint>;

/// A `Complaint` to return from a function that returns what is checked.
inline tl::unexpected<Complaint> refused(std::string message, std::size_t index = 0) {
  return tl::unexpected(Complaint{index, std::move(message)});
}

/// An `Error` to return from a function that returns a `Result`.
inline tl::unexpected<Error> fail(ErrorCode code, std::string message, std::string file = {},
                                  int line = 0) {
  return tl::unexpected<Error>(
      Error{.code = code, .message = std::move(message), .file = std::move(file), .line = line});
}

/// An `Error` about user input; line 0: unknown.
inline tl::unexpected<Error> invalid(std::string message, int line = 0) {
  return fail(ErrorCode::InvalidInput, std::move(message), {}, line);
}

/// Passes an error on unchanged.
inline tl::unexpected<Error> fail(Error error) { return tl::unexpected<Error>(std::move(error)); }

/// The text with these written as `\xHH`: characters that break a line or control a terminal (C0
/// and C1 controls, line separators, marks of writing direction) and bytes that are not UTF-8.
/// Idempotent.
std::string printable(std::string_view text);

/// The errors and their `others` in one list: those of `file` first, those of a file in the order
/// of lines, each once.
std::vector<Error> sorted(std::vector<Error> errors, std::string_view file);

/// The first of `sorted`, with the others. Requires: not empty.
Error as_one(std::vector<Error> errors, std::string_view file);

/// The first problem and all others, one line each: `FILE:LINE: error: MESSAGE`; unknown parts are
/// omitted.
std::vector<std::string> to_lines(const Error& error);

}  // namespace pliant
