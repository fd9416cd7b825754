#include "pliant/mesh/file_reference.hpp"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "pliant/core/read_file.hpp"
#include "pliant/mesh/file_object.hpp"

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

bool is_below(const fs::path& file, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first ==
         folder.end();
}

bool is_there(const fs::path& file) {
  std::error_code ignored;
  return fs::exists(file, ignored);
}

// Rejects URIs that are not relative paths to a file.
Result<void> check_uri(const std::string& uri, std::string_view decoded) {
  if (const std::string_view scheme = scheme_of(uri); !scheme.empty()) {
    return refuse(uri, fmt::format("but the scheme {} is not supported; only files are read",
                                   in_quotes(scheme)));
  }
  if (decoded.starts_with('/'))
    return refuse(uri, "which is an absolute path; a relative one is required");
  if (decoded.find('\0') != std::string_view::npos)
    return refuse(uri, "which is not the name of a file");
  return {};
}

}  // namespace

Result<fs::path> find_reference(const std::string& uri, const fs::path& mesh_file,
                                const fs::path& root) {
  const std::string decoded = percent_decoded(uri);
  if (auto checked = check_uri(uri, decoded); !checked) return fail(checked.error());
  const fs::path folder = or_current(mesh_file.parent_path());
  std::error_code trouble;
  const fs::path allowed = fs::canonical(root.empty() ? folder : root, trouble);
  if (trouble) return refuse(uri, "but the folder that must contain it cannot be found");
  // Resolves links before checking whether the file exists.
  const auto place = [&](const std::string& path) {
    return fs::weakly_canonical(fs::absolute(folder / path, trouble), trouble);
  };
  const fs::path as_written = place(uri);
  const bool is_written = !trouble && is_below(as_written, allowed) && is_there(as_written);
  const fs::path file = is_written ? as_written : place(decoded);
  if (trouble) return refuse(uri, fmt::format("which cannot be found: {}", trouble.message()));
  if (!is_below(file, allowed)) {
    return refuse(uri, fmt::format("which is outside {}; --root DIR allows another folder",
                                   allowed.string()));
  }
  if (fs::is_symlink(fs::symlink_status(file, trouble)))
    return refuse(uri, "a symbolic link to a file that does not exist");
  return file;
}

Result<void> check_below(const fs::path& file, const fs::path& root) {
  if (root.empty()) return {};
  const auto refuse_file = [&](const std::string& reason) {
    return fail(ErrorCode::InvalidInput, reason, file.string());
  };
  std::error_code trouble;
  const auto real = [&](const fs::path& path) {
    return fs::weakly_canonical(fs::absolute(path, trouble), trouble);
  };
  const fs::path allowed = real(root);
  if (trouble) return refuse_file("the folder that must contain it cannot be found");
  const fs::path found = real(file);
  if (trouble) return refuse_file(fmt::format("it cannot be found: {}", trouble.message()));
  if (!is_below(found, allowed))
    return refuse_file(fmt::format("it is outside {}, the folder of --root", allowed.string()));
  if (fs::is_symlink(fs::symlink_status(found, trouble)))
    return refuse_file("it is a symbolic link to a file that does not exist");
  return {};
}

Result<std::string> read_reference(const std::string& uri, const fs::path& mesh_file,
                                   const fs::path& root, std::size_t max_bytes) {
  const auto file = find_reference(uri, mesh_file, root);
  if (!file) return fail(file.error());
  std::error_code ignored;
  // A read from a pipe or a device could block, or never end.
  if (is_there(*file) && !fs::is_regular_file(*file, ignored)) {
    return fail(ErrorCode::InvalidInput,
                fmt::format("the file refers to {}: cannot read the file: it is not a regular file",
                            file->string()));
  }
  auto bytes = read_file(*file, max_bytes);
  if (bytes) return bytes;
  return fail(ErrorCode::InvalidInput,
              fmt::format("the file refers to {}: {}", file->string(), bytes.error().message));
}

}  // namespace pliant
