#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/files/atomic_file.hpp"

namespace pliant {

/// A temporary file for bytes that can be written to their file only later, such as those after a
/// header that contains their number. It is on the same disk as that file and has no name, so that
/// nothing remains of it if the program is killed.
class SpoolFile {
 public:
  /// Bytes for `file`. Errors: Unwritable, naming that file and the reason.
  static Result<SpoolFile> create(const std::filesystem::path& file);

  /// Appends. Errors: Unwritable.
  Result<void> write(std::string_view bytes);

  std::uint64_t size() const { return size_; }  ///< [bytes]

  /// Appends everything written so far to another file. Errors: Unwritable, for either file;
  /// Interrupted.
  Result<void> copy_to(AtomicFile& file, const StopRequest& should_stop = {});

 private:
  struct Close {
    void operator()(std::FILE* stream) const { std::fclose(stream); }
  };
  using Stream = std::unique_ptr<std::FILE, Close>;

  SpoolFile(std::filesystem::path file, Stream stream);
  tl::unexpected<Error> unwritable(int error_number) const;

  std::filesystem::path file_;
  Stream stream_;
  std::uint64_t size_ = 0;
};

}  // namespace pliant
