#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant {

/// Receives the bytes of a file, piece by piece.
using ByteSink = std::function<Result<void>(std::string_view)>;

/// The bytes that are written between two times of asking.
inline constexpr std::size_t bytes_of_piece = std::size_t{1} << 20U;

/// Calls write(piece) for pieces of the bytes, and asks before each. Errors: those of `write`;
/// Interrupted.
template <class Write>
Result<void> write_in_pieces(std::string_view bytes, const StopRequest& should_stop,
                             const Write& write) {
  for (; !bytes.empty(); bytes.remove_prefix(std::min(bytes.size(), bytes_of_piece))) {
    if (is_stopped(should_stop)) return interrupted();
    if (auto written = write(bytes.substr(0, bytes_of_piece)); !written) return written;
  }
  return {};
}

/// Text on its way to a sink, which gets it in pieces. It must outlive this.
class TextPieces {
 public:
  TextPieces(const ByteSink& sink, const StopRequest& should_stop)
      : sink_(sink), should_stop_(should_stop) {}

  std::string text = {};  ///< is appended to; what was passed on is gone

  /// Passes the text on if there is enough of it. Errors: those of the sink; Interrupted.
  Result<void> pass_on() {
    if (text.size() < bytes_of_piece) return {};
    return finish();
  }

  /// Passes all of it on.
  Result<void> finish() {
    auto written = write_in_pieces(text, should_stop_, sink_);
    text.clear();
    return written;
  }

 private:
  const ByteSink& sink_;
  const StopRequest& should_stop_;
};

}  // namespace pliant
