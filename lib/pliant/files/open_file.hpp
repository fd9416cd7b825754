#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

#include <sys/stat.h>

#include "pliant/core/result.hpp"

namespace pliant {

/// An open descriptor, closed by the destructor; -1: none.
class OpenDescriptor {
 public:
  explicit OpenDescriptor(int number = -1) : number_(number) {}
  OpenDescriptor(OpenDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  OpenDescriptor& operator=(OpenDescriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~OpenDescriptor();

  bool is_open() const { return number_ >= 0; }
  int number() const { return number_; }

 private:
  int number_;
};

/// A regular file, open for reading. What it tells is that of the file that was opened, whatever
/// its name leads to by now.
class OpenFile {
 public:
  /// With a `root`, the file must be in this folder or below once all links are resolved, also if
  /// links and folders are renamed meanwhile; empty: it may be anywhere. Waits for no pipe. Errors,
  /// naming the file: InvalidInput: it is outside the root, in the same words whether or not it
  /// exists; Unreadable: it does not exist, may not be read, is a folder or no regular file.
  static Result<OpenFile> open(const std::filesystem::path& file,
                               const std::filesystem::path& root = {});

  const std::string& name() const { return name_; }
  int descriptor() const { return descriptor_.number(); }

  std::uint64_t size() const;  ///< when it was opened [bytes]

  /// What tells it from all other files, whatever links lead to it.
  std::string identity() const;

  /// Changes whenever the file does, as far as the system knows.
  std::string stamp() const;

 private:
  OpenFile(std::string name, OpenDescriptor descriptor, const struct stat& status);

  std::string name_;
  OpenDescriptor descriptor_;
  struct stat status_;
};

/// The path of a file, existing or not, without links in it, if that is in the folder `root` or
/// below; an empty `root` contains all, and the path is the given one. For messages and names: who
/// reads the file opens it below the root. Errors: InvalidInput, as `OpenFile::open`.
Result<std::filesystem::path> find_below(const std::filesystem::path& file,
                                         const std::filesystem::path& root);

}  // namespace pliant
