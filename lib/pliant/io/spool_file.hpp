#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/io/atomic_file.hpp"

namespace pliant {

/// Bytes on their way into a file that can take them only later, such as those behind a header that
/// has to say how many there are. On the same disk as that file, without a name, so that nothing is
/// left of them whatever ends the program.
class SpoolFile {
 public:
  /// Bytes for `file`. Errors: Unwritable, naming that file and the reason.
  static Result<SpoolFile> create(const std::filesystem::path& file);

  /// Appends. Errors: Unwritable.
  Result<void> write(std::string_view bytes);

  std::uint64_t size() const { return size_; }  ///< [bytes]

  /// Appends all that was written to another file. Errors: Unwritable, of either.
  Result<void> copy_to(AtomicFile& file);

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
