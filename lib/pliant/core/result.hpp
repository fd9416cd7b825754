#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

namespace pliant {

/// What kind of trouble an `Error` reports; the command turns it into an exit code.
enum class ErrorCode {
  InvalidInput,  ///< a scene, mesh or argument breaks a documented rule
  Unreadable,    ///< a file could not be opened or read
  Unwritable,    ///< a file could not be created, written or renamed
  OutOfMemory,   ///< the work does not fit in memory
  SolverFailed,  ///< a linear system could not be factored or solved
  NotFinite,     ///< a state stopped being finite
  Interrupted,   ///< the caller asked to stop
};

/// One problem: what is wrong, and where. `others` holds further problems found in the same run,
/// in the order in which they were found; theirs is empty.
struct Error {
  ErrorCode code = ErrorCode::InvalidInput;
  std::string message;    ///< one line: the thing, the value, the rule
  std::string file = {};  ///< empty: no file is at fault
  int line = 0;           ///< counted from 1; 0: no line is known
  std::vector<Error> others = {};
};

/// A value, or the reason why there is none: a `tl::expected` that must not be dropped unread.
template <class T>
class [[nodiscard]] Result : public tl::expected<T, Error> {
 public:
  using tl::expected<T, Error>::expected;
  Result() = default;
  Result(tl::expected<T, Error> result) : tl::expected<T, Error>(std::move(result)) {}
};

/// An `Error` ready to be returned from a function that gives a `Result`.
inline tl::unexpected<Error> fail(ErrorCode code, std::string message, std::string file = {},
                                  int line = 0) {
  return tl::unexpected<Error>(
      Error{.code = code, .message = std::move(message), .file = std::move(file), .line = line});
}

/// An `Error` about what a user gave; 0: no line is known.
inline tl::unexpected<Error> invalid(std::string message, int line = 0) {
  return fail(ErrorCode::InvalidInput, std::move(message), {}, line);
}

/// Hands an error on as it is.
inline tl::unexpected<Error> fail(Error error) { return tl::unexpected<Error>(std::move(error)); }

/// The text with what would break a line or act on a terminal, and what is no UTF-8, as `\xHH`: C0
/// and C1 controls, separators of lines, marks of writing direction. Done twice it changes nothing.
std::string printable(std::string_view text);

/// The first problem and all others, one line each: `FILE:LINE: error: MESSAGE`, without the parts
/// that are not known.
std::vector<std::string> to_lines(const Error& error);

}  // namespace pliant
