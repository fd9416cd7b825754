#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include "pliant/core/result.hpp"

namespace pliant {

/// What of a file is on the disk once it is committed, and survives a power cut.
enum class Flush {
  Nothing,  ///< what the system has written by then: for what can be had again
  Bytes,  ///< the bytes, ahead of the rename, so that under the name there is a whole file always;
          ///< the name itself once `flush_folder` is called
  All,    ///< the bytes ahead of the rename, and the name after it
};

/// A file that appears whole under its name or not at all: written beside it under another name,
/// which `commit` renames. Without a commit nothing is left behind and what was there before stays.
class AtomicFile {
 public:
  /// Errors: those of `check_output_place`; Unwritable, naming the file and the reason.
  static Result<AtomicFile> create(const std::filesystem::path& file, Flush flush = Flush::All);

  AtomicFile(AtomicFile&&) = default;
  AtomicFile& operator=(AtomicFile&&) = delete;
  ~AtomicFile();

  /// Appends. Errors: Unwritable, when the disk is full for one.
  Result<void> write(std::string_view bytes);
  Result<void> write(std::span<const double> numbers);  ///< little endian
  Result<void> write(std::span<const float> numbers);   ///< little endian

  /// Gives the file its name. Errors: Unwritable. Requires: not committed yet.
  Result<void> commit();

  /// Gives it another name of the same folder, where what it holds decides what it is called.
  Result<void> commit_as(const std::filesystem::path& file);

 private:
  struct Close {
    void operator()(std::FILE* stream) const { std::fclose(stream); }
  };
  using Stream = std::unique_ptr<std::FILE, Close>;

  AtomicFile(std::filesystem::path file, std::string part, Stream stream, Flush flush);
  Result<void> finish_bytes();
  tl::unexpected<Error> unwritable(int error_number) const;

  std::filesystem::path file_;
  std::string part_;  // what it is called in the file's folder until commit
  Stream stream_;
  Flush flush_;
};

/// Has the names in the folder of `file` written to the disk; nothing on file systems that cannot.
/// Errors: Unwritable, naming the file.
Result<void> flush_folder(const std::filesystem::path& file);

}  // namespace pliant
