#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/files/gltf/gltf_document.hpp"
#include "pliant/files/gltf/read_gltf.hpp"

namespace pliant::gltf {

/// What a URI names: the same text for all URIs of one file.
using IdentifyReference = std::function<std::string(const std::string& uri)>;

/// The bytes of a document's buffers, each file read on first use, and once. `document`, `binary`
/// and the captures of `read_file` must outlive it.
class Buffers {
 public:
  /// `identify` empty: each URI is another file.
  Buffers(const Document& document, std::optional<std::string_view> binary, std::size_t file_size,
          const ReadReference& read_file, IdentifyReference identify = {},
          StopRequest should_stop = {});

  /// As many bytes as the document declares for the buffer. Errors: there are fewer; a URI that
  /// cannot be read; Interrupted.
  Result<std::string_view> bytes(std::size_t buffer);

  /// Bytes of the file and of all other files read so far.
  std::size_t size_so_far() const { return size_so_far_; }

 private:
  Result<std::string_view> read(std::size_t buffer);

  const Document& document_;
  std::optional<std::string_view> binary_;
  std::size_t size_so_far_;
  const ReadReference& read_file_;
  IdentifyReference identify_;
  StopRequest should_stop_;
  std::vector<std::optional<std::string_view>> read_;  // one per buffer
  std::map<std::string, std::string> files_;           // their bytes
  std::deque<std::string> data_;                       // of URIs that contain them
};

/// Whether a buffer's URI contains the bytes itself.
bool is_data(std::string_view uri);

}  // namespace pliant::gltf
