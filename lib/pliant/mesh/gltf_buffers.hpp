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

/// The bytes that a document's buffers hold, each read when it is first asked for. `document`,
/// `binary` and what `read_file` refers to outlive it.
class Buffers {
 public:
  Buffers(const Document& document, std::optional<std::string_view> binary, std::size_t file_size,
          const ReadReference& read_file);

  /// As many bytes as the document says that the buffer has. Errors: fewer are there; a URI that
  /// cannot be read.
  Result<std::string_view> bytes(std::size_t buffer);

  /// Of the file, and of all that was read besides.
  std::size_t size_so_far() const { return size_so_far_; }

 private:
  Result<std::string> read(std::size_t buffer) const;

  const Document& document_;
  std::optional<std::string_view> binary_;
  std::size_t size_so_far_;
  const ReadReference& read_file_;
  std::vector<std::optional<std::string>> owned_;  // one a buffer
};

/// Whether a buffer's URI holds its bytes itself.
bool is_data(std::string_view uri);

}  // namespace pliant::gltf
