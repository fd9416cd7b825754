#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant {

class OpenFolder;

/// The parts of a file that are flushed to the disk by a commit, and so survive a power cut.
enum class Flush {
  Nothing,  ///< nothing: for files that can be made again
  Bytes,  ///< the bytes, before the rename, so that the name always refers to a complete file; the
          ///< name itself only after `flush_folder`
  All,    ///< the bytes before the rename, and the name after it
};

/// A file that appears whole under its name or not at all: written beside it under another name,
/// then renamed by `commit`. Without a commit nothing is left behind and an older file stays. It
/// has the permissions, access list, attributes (`user.`), owner and group of the file that it
/// replaces, as far as this process may give them.
class AtomicFile {
 public:
  /// Errors: those of `check_output_place`; Unwritable, naming the file and the reason.
  static Result<AtomicFile> create(const std::filesystem::path& file, Flush flush = Flush::All);

  AtomicFile(AtomicFile&&) = default;
  AtomicFile& operator=(AtomicFile&&) = delete;
  ~AtomicFile();

  /// Appends. Errors: Unwritable, for example if the disk is full; Interrupted.
  Result<void> write(std::string_view bytes, const StopRequest& should_stop = {});
  Result<void> write(std::span<const double> numbers);  ///< little-endian
  Result<void> write(std::span<const float> numbers);   ///< little-endian

  /// Gives the file its name. Errors: Unwritable. Requires: not committed before.
  Result<void> commit();

  /// The same, but never in place of another file, however many processes do this at once. Whether
  /// it has the name now; if not, its bytes are gone.
  Result<bool> commit_new();

  /// As `commit`, but only in place of a file with just these bytes: those that the new ones are
  /// made of. What another program saves meanwhile stays, up to the last moment. Without a file of
  /// that name, this is a new one. Errors also: Unwritable: the file has other bytes by now; it
  /// belongs to another user or group, or has an access list, which this process cannot give it.
  Result<void> commit_over(std::string_view old_bytes);

  /// As `commit`, with another name in the same folder, for a file whose name depends on its
  /// content.
  Result<void> commit_as(const std::filesystem::path& file);

 private:
  struct Close {
    void operator()(std::FILE* stream) const { std::fclose(stream); }
  };
  friend Result<void> commit_all(std::vector<AtomicFile> files);

  // How a file got its name.
  enum class Placed {
    New,        // no other file had it
    Exchanged,  // the older file has the name of the part now
    Replaced,   // the older file is gone, where the file system cannot exchange them
  };

  using Stream = std::unique_ptr<std::FILE, Close>;

  AtomicFile(std::filesystem::path file, std::string part, Stream stream, Flush flush,
             bool is_as_old);
  Result<void> finish_bytes();
  Result<void> replace(const OpenFolder& folder, int own, std::string_view old_bytes);
  Result<Placed> exchange(const OpenFolder& folder) const;
  Result<bool> place(const std::filesystem::path& file, bool only_new);
  tl::unexpected<Error> unwritable(int error_number) const;

  std::filesystem::path file_;
  std::string part_;  // its name in the folder until commit
  Stream stream_;
  Flush flush_;
  bool is_as_old_;  // whoever may access the older file may access this one, and nobody else
};

/// Gives files of one folder their names, in this order: all of them, or none, after which all
/// older files are as they were, where the file system can exchange two files. After a power cut
/// the last one has its name only if the others have theirs. Errors: as `AtomicFile::commit`; that
/// an older file has become something else. Requires: none is committed, and all flush alike.
Result<void> commit_all(std::vector<AtomicFile> files);

/// Writes a whole file at once. Errors: those of `AtomicFile`.
Result<void> write_file(const std::filesystem::path& file, std::string_view bytes,
                        const StopRequest& should_stop = {});

/// The same in place of a file that had `old_bytes` when it was read. Errors: those of
/// `AtomicFile::commit_over`.
Result<void> rewrite_file(const std::filesystem::path& file, std::string_view old_bytes,
                          std::string_view bytes);

/// Flushes the names in the folder of `file` to the disk; does nothing on file systems without that
/// operation. Errors: Unwritable, naming the file.
Result<void> flush_folder(const std::filesystem::path& file);

}  // namespace pliant
