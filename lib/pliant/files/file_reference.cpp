#include "pliant/files/file_reference.hpp"

#include <charconv>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "pliant/files/file_object.hpp"
#include "pliant/files/open_file.hpp"
#include "pliant/files/read_file.hpp"

namespace pliant {
namespace {

namespace fs = std::filesystem;

tl::unexpected<Error> refuse(const std::string& uri, std::string_view reason) {
  return fail(ErrorCode::InvalidInput,
              fmt::format("the file refers to {}, {}", in_quotes(uri), reason));
}

std::string percent_decoded(std::string_view uri) {
  std::string text;
  for (std::size_t k = 0; k < uri.size(); ++k) {
    unsigned char byte = 0;
    const char* digits = uri.data() + k + 1;
    if (uri[k] == '%' && uri.size() - k > 2 &&
        std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2) {
      text += static_cast<char>(byte);
      k += 2;
    } else {
      text += uri[k];
    }
  }
  return text;
}

// `http`, `file`, or `C` for C:\a.bin; empty: the URI is relative. RFC 3986, 3.1.
std::string_view scheme_of(std::string_view uri) {
  const std::size_t end = uri.find_first_of(":/?#");
  const bool has_scheme = end != std::string_view::npos && end > 0 && uri[end] == ':';
  return has_scheme ? uri.substr(0, end) : std::string_view();
}

fs::path or_current(const fs::path& folder) { return folder.empty() ? fs::path(".") : folder; }

// Rejects URIs that are not relative paths to a file.
Result<void> check_uri(const std::string& uri, std::string_view decoded) {
  if (const std::string_view scheme = scheme_of(uri); !scheme.empty()) {
    return refuse(uri, fmt::format("but the scheme {} is not supported; only files are read",
                                   in_quotes(scheme)));
  }
  if (decoded.starts_with('/'))
    return refuse(uri, "which is an absolute path; a relative one is required");
  constexpr std::size_t longest_path = 4096;  // of Linux; a longer one takes long to resolve
  if (decoded.find('\0') != std::string_view::npos || uri.size() > longest_path)
    return refuse(uri, "which is not the name of a file");
  return {};
}

struct Reference {
  fs::path file;
  fs::path root;  // the folder that must contain it
  fs::path real;  // the file, without links in its path
};

// The URI unchanged, if that is a file, or else decoded.
Result<Reference> resolve(const std::string& uri, const fs::path& mesh_file, const fs::path& root) {
  const std::string decoded = percent_decoded(uri);
  if (auto checked = check_uri(uri, decoded); !checked) return fail(checked.error());
  const fs::path folder = or_current(mesh_file.parent_path());
  std::error_code trouble;
  const fs::path allowed = fs::canonical(root.empty() ? folder : root, trouble);
  if (trouble) return refuse(uri, "but the folder that must contain it cannot be found");
  const bool is_written = uri != decoded && OpenFile::open(folder / uri, allowed).has_value();
  const fs::path file = folder / (is_written ? uri : decoded);
  if (auto real = find_below(file, allowed)) return Reference{file, allowed, *std::move(real)};
  return refuse(
      uri, fmt::format("which is outside {}; --root DIR allows another folder", allowed.string()));
}

}  // namespace

Result<fs::path> find_reference(const std::string& uri, const fs::path& mesh_file,
                                const fs::path& root) {
  auto found = resolve(uri, mesh_file, root);
  if (!found) return fail(found.error());
  return std::move(found->real);
}

Result<std::string> read_reference(const std::string& uri, const fs::path& mesh_file,
                                   const fs::path& root, std::size_t max_bytes,
                                   const StopRequest& should_stop) {
  const auto found = resolve(uri, mesh_file, root);
  if (!found) return fail(found.error());
  const auto opened = OpenFile::open(found->file, found->root);
  Result<std::string> bytes = opened ? read_file(*opened, max_bytes, should_stop)
                                     : Result<std::string>(fail(opened.error()));
  if (bytes || bytes.error().code == ErrorCode::Interrupted) return bytes;
  return fail(ErrorCode::InvalidInput, fmt::format("the file refers to {}: {}",
                                                   found->real.string(), bytes.error().message));
}

}  // namespace pliant
