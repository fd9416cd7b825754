#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include "pliant/core/result.hpp"

namespace pliant {

/// A file that appears whole under its name or not at all: written beside it under another name,
/// which `commit` renames. Without a commit nothing is left behind and what was there before stays.
class AtomicFile {
 public:
  /// Errors: Unwritable, naming the file and the reason; a folder of that name among them.
  static Result<AtomicFile> create(const std::filesystem::path& file);

  AtomicFile(AtomicFile&&) = default;
  AtomicFile& operator=(AtomicFile&&) = delete;
  ~AtomicFile();

  /// Appends. Errors: Unwritable, when the disk is full for one.
  Result<void> write(std::string_view bytes);
  Result<void> write(std::span<const double> numbers);  ///< little endian
  Result<void> write(std::span<const float> numbers);   ///< little endian

  /// Gives the file its name. Errors: Unwritable. Requires: not committed yet.
  Result<void> commit();

 private:
  struct Close {
    void operator()(std::FILE* stream) const { std::fclose(stream); }
  };
  using Stream = std::unique_ptr<std::FILE, Close>;

  AtomicFile(std::filesystem::path file, std::filesystem::path part, Stream stream);
  tl::unexpected<Error> unwritable(int error_number) const;

  std::filesystem::path file_;
  std::filesystem::path part_;  // where the bytes go until commit
  Stream stream_;
};

}  // namespace pliant
