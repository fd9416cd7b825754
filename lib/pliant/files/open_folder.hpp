#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "pliant/files/open_file.hpp"

namespace pliant {

// The folder of a file, kept open, so that names in it, and the path to it, may be as long as the
// system allows. Functions return 0 or an errno. Internal to output.
class OpenFolder {
 public:
  /// The folder of `file`; `error` is the errno if it cannot be opened, 0: it is open.
  explicit OpenFolder(const std::filesystem::path& file);

  int error() const { return error_; }
  int descriptor() const { return descriptor_.number(); }

  int rename(const std::string& from, const std::string& to) const;
  /// The same, but EEXIST if there is a file with the new name.
  int rename_new(const std::string& from, const std::string& to) const;
  /// Two files have each other's name, in one step.
  int exchange(const std::string& one, const std::string& other) const;
  void remove(const std::string& name) const;

  /// Whether a name is that of a regular file, not of a link, with just these bytes.
  bool has(const std::string& name, std::string_view bytes) const;
  /// Whether it is that of an open file.
  bool is(const std::string& name, int descriptor) const;

  /// Flushes the folder's names to the disk; also returns 0 if the file system does not support
  /// this, or if the folder is writable but not readable, in which case it is impossible.
  int flush() const;

  /// Waits until no other process has the lock of the folder, ten seconds at most, and locks it
  /// until this object is destroyed. Does nothing if the file system has no locks.
  void lock() const;

 private:
  OpenDescriptor descriptor_;
  int error_ = 0;
  bool is_readable_ = false;
};

/// Flushes the content of an open file to the disk: 0, or the errno. Also 0 if the file system does
/// not support this.
int flush_descriptor(int descriptor);

}  // namespace pliant
