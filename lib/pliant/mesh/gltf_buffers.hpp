#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/mesh/gltf_document.hpp"
#include "pliant/mesh/read_gltf.hpp"

namespace pliant::gltf {

/// The bytes of a document's buffers, each read on first use. `document`, `binary` and the captures
/// of `read_file` must outlive it.
class Buffers {
 public:
  Buffers(const Document& document, std::optional<std::string_view> binary, std::size_t file_size,
          const ReadReference& read_file);

  /// As many bytes as the document declares for the buffer. Errors: there are fewer; a URI that
  /// cannot be read.
  Result<std::string_view> bytes(std::size_t buffer);

  /// Bytes of the file and of all other files read so far.
  std::size_t size_so_far() const { return size_so_far_; }

 private:
  Result<std::string> read(std::size_t buffer) const;

  const Document& document_;
  std::optional<std::string_view> binary_;
  std::size_t size_so_far_;
  const ReadReference& read_file_;
  std::vector<std::optional<std::string>> owned_;  // one per buffer
};

/// Whether a buffer's URI contains the bytes itself.
bool is_data(std::string_view uri);

}  // namespace pliant::gltf
