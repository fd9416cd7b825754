#pragma once

#include <filesystem>
#include <string>
#include <utility>

namespace pliant {

// The folder of a file, held open, so that names in it may be as long as the system allows and the
// path to it too. Functions give 0 or an errno. Not for other rooms.
class OpenFolder {
 public:
  /// The folder that `file` is in; `error` says why it cannot be opened, 0: it is open.
  explicit OpenFolder(const std::filesystem::path& file);
  OpenFolder(OpenFolder&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)),
        error_(other.error_),
        is_readable_(other.is_readable_) {}
  OpenFolder& operator=(OpenFolder&&) = delete;
  ~OpenFolder();

  int error() const { return error_; }
  int descriptor() const { return descriptor_; }

  int rename(const std::string& from, const std::string& to) const;
  void remove(const std::string& name) const;

  /// Writes the folder's names to the disk; 0 also where the file system has no such thing, or
  /// where the folder may be written to but not read, for which there is no way.
  int flush() const;

  /// Waits until no other process holds the folder, ten seconds at most, and holds it until this
  /// object goes. Where the file system knows no locks nothing happens.
  void lock() const;

 private:
  int descriptor_ = -1;
  int error_ = 0;
  bool is_readable_ = false;
};

/// Writes what an open file holds to the disk: 0, or the errno. 0 also where the file system has no
/// such thing.
int flush_descriptor(int descriptor);

}  // namespace pliant
