#include "pliant/files/open_file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <cstring>
#include <optional>
#include <string_view>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

namespace pliant {
namespace {

namespace fs = std::filesystem;

struct Identity {
  dev_t device = 0;
  ino_t number = 0;
  friend bool operator==(const Identity&, const Identity&) = default;
};

std::optional<struct stat> status_of(const OpenDescriptor& descriptor) {
  struct stat status = {};
  if (!descriptor.is_open() || fstat(descriptor.number(), &status) != 0) return {};
  return status;
}

Identity identity_of(const struct stat& status) { return {status.st_dev, status.st_ino}; }

// Without O_NONBLOCK a pipe would wait for its writer.
constexpr int reading = O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY;

// A folder, or a link itself: neither is read, and nothing waits.
OpenDescriptor point_at(const OpenDescriptor& folder, const char* name) {
  return OpenDescriptor(openat(folder.number(), name, O_PATH | O_NOFOLLOW | O_CLOEXEC));
}

OpenDescriptor top_folder() { return OpenDescriptor(open("/", O_PATH | O_DIRECTORY | O_CLOEXEC)); }

// Walks from "/" to where a path leads, one name after the other, and resolves links itself, so
// that nothing that is renamed meanwhile leads it out of the root unnoticed: from the root on, each
// step goes from an open folder to what is in it, or back to the folder it came from.
class Walk {
 public:
  Walk(const fs::path& path, const OpenDescriptor& root, const fs::path& real_root)
      : real_root_(real_root) {
    if (const auto status = status_of(root)) {
      root_ = identity_of(*status);
      restart();
    } else {
      error_ = ENOENT;  // nor is there anything in it
    }
    put_ahead(path);
    while (!ahead_.empty()) step();
  }

  /// Whether it leads to something in the root or below, existing or not.
  bool ends_inside() const {
    if (error_ == 0) return !inside_.empty() && missing_ == 0;
    const fs::path end = real();
    return std::mismatch(real_root_.begin(), real_root_.end(), end.begin(), end.end()).first ==
           real_root_.end();
  }
  int error() const { return error_; }  ///< 0: what it leads to exists
  fs::path real() const {
    std::string path;
    for (const std::string& name : names_) path += '/' + name;
    return path.empty() ? "/" : path;
  }

  /// Requires: ends_inside, and there is no error.
  Result<OpenDescriptor> open_end(const std::string& name) const {
    const auto refuse = [&](std::string_view reason) {
      return fail(ErrorCode::Unreadable, fmt::format("cannot read the file: {}", reason), name);
    };
    if (!end_) return refuse("it is a folder");
    if (!S_ISREG(end_->st_mode)) return refuse("it is not a regular file");
    OpenDescriptor opened(openat(top_.number(), names_.back().c_str(), reading | O_NOFOLLOW));
    if (!opened.is_open()) return refuse(std::strerror(errno));
    return opened;
  }

 private:
  void restart() {
    names_.clear();
    inside_.clear();
    if (auto top = top_folder(); const auto status = status_of(top)) enter(std::move(top), *status);
  }

  void put_ahead(const fs::path& path) {
    const std::size_t old = ahead_.size();
    for (const fs::path& name : path.relative_path()) ahead_.push_back(name.string());
    std::reverse(ahead_.begin() + static_cast<std::ptrdiff_t>(old), ahead_.end());
  }

  void step() {
    const std::string name = std::move(ahead_.back());
    ahead_.pop_back();
    if (name.empty() || name == ".") return;
    if (name == "..") return up();
    if (error_ != 0 || missing_ != 0) return miss(name, error_);
    OpenDescriptor next = point_at(top_, name.c_str());
    const auto status = status_of(next);
    if (!status) return miss(name, errno);
    if (S_ISLNK(status->st_mode)) return follow(next, name);
    if (!S_ISDIR(status->st_mode) && !ahead_.empty()) return miss(name, ENOTDIR);
    names_.push_back(name);
    if (!S_ISDIR(status->st_mode)) {
      end_ = status;
      return;
    }
    if (!inside_.empty()) inside_.push_back(identity_of(*status));
    enter(std::move(next), *status);
  }

  void up() {
    if (!names_.empty()) names_.pop_back();
    if (error_ != 0) return;
    if (missing_ != 0) {
      --missing_;
      return;
    }
    OpenDescriptor above = point_at(top_, "..");
    const auto status = status_of(above);
    if (!status) {
      error_ = errno;
      return;
    }
    if (inside_.size() > 1 && inside_[inside_.size() - 2] != identity_of(*status)) {
      error_ = ESTALE;  // it was moved meanwhile, perhaps out of the root
      return;
    }
    if (!inside_.empty()) inside_.pop_back();
    enter(std::move(above), *status);
  }

  void enter(OpenDescriptor folder, const struct stat& status) {
    top_ = std::move(folder);
    if (inside_.empty() && identity_of(status) == root_) inside_.push_back(root_);
  }

  // What cannot be found in the root is an error, and the rest of the path is only read for where
  // it would lead. Outside, a path must not tell what is there: a name that cannot be found is as
  // good as any, if the path comes back.
  void miss(const std::string& name, int reason) {
    names_.push_back(name);
    const bool is_of_system = reason == EMFILE || reason == ENFILE || reason == ENOMEM;
    if (inside_.empty() && !is_of_system) {
      ++missing_;
    } else {
      error_ = reason;
    }
  }

  void follow(const OpenDescriptor& link, const std::string& name) {
    constexpr int most_links = 40;  // as the system
    std::array<char, PATH_MAX> target;
    const ssize_t size = readlinkat(link.number(), "", target.data(), target.size());
    if (size <= 0) return miss(name, ENOENT);
    if (++link_count_ > most_links) return miss(name, ELOOP);
    const fs::path path(std::string_view(target.data(), static_cast<std::size_t>(size)));
    put_ahead(path);
    if (path.is_absolute()) restart();
  }

  fs::path real_root_;
  Identity root_;
  OpenDescriptor top_;                   // the folder it has come to
  std::vector<Identity> inside_ = {};    // folders from the root to `top_`; empty: it is outside
  std::vector<std::string> names_ = {};  // of where it has come to, from "/"
  std::vector<std::string> ahead_ = {};  // those to come, the next one last
  std::size_t missing_ = 0;  // how many of the last names are outside and cannot be found
  int link_count_ = 0;
  int error_ = 0;
  std::optional<struct stat> end_;  // what it leads to, unless that is a folder
};

// Where a path leads, if not out of the root.
Result<Walk> walk_below(const fs::path& file, const fs::path& root) {
  const auto refuse = [&](const std::string& reason) {
    return fail(ErrorCode::InvalidInput, reason, file.string());
  };
  std::error_code trouble;
  const fs::path real_root = fs::weakly_canonical(fs::absolute(root, trouble), trouble);
  if (trouble) return refuse("the folder that must contain it cannot be found");
  const OpenDescriptor folder(open(root.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  const fs::path whole = fs::absolute(file, trouble);
  if (!trouble && whole.native().size() >= PATH_MAX)
    trouble = std::make_error_code(std::errc::filename_too_long);
  if (trouble) return refuse(fmt::format("it cannot be found: {}", trouble.message()));
  Walk walk(whole, folder, real_root);
  if (!walk.ends_inside())
    return refuse(fmt::format("it is outside {}, the folder of --root", real_root.string()));
  return walk;
}

Result<OpenDescriptor> open_anywhere(const fs::path& file) {
  const auto refuse = [&](std::string_view reason) {
    return fail(ErrorCode::Unreadable, fmt::format("cannot read the file: {}", reason),
                file.string());
  };
  // Some devices do something when they are opened.
  struct stat status = {};
  if (stat(file.c_str(), &status) != 0) return refuse(std::strerror(errno));
  if (S_ISDIR(status.st_mode)) return refuse("it is a folder");
  if (!S_ISREG(status.st_mode)) return refuse("it is not a regular file");
  OpenDescriptor opened(open(file.c_str(), reading));
  if (!opened.is_open()) return refuse(std::strerror(errno));
  return opened;
}

Result<OpenDescriptor> open_below(const fs::path& file, const fs::path& root) {
  const auto walk = walk_below(file, root);
  if (!walk) return fail(walk.error());
  if (walk->error() != 0)
    return fail(ErrorCode::Unreadable,
                fmt::format("cannot read the file: {}", std::strerror(walk->error())),
                file.string());
  return walk->open_end(file.string());
}

}  // namespace

OpenDescriptor::~OpenDescriptor() {
  if (is_open()) close(number_);
}

OpenFile::OpenFile(std::string name, OpenDescriptor descriptor, const struct stat& status)
    : name_(std::move(name)), descriptor_(std::move(descriptor)), status_(status) {}

Result<OpenFile> OpenFile::open(const fs::path& file, const fs::path& root) {
  auto opened = root.empty() ? open_anywhere(file) : open_below(file, root);
  if (!opened) return fail(opened.error());
  const auto status = status_of(*opened);
  if (!status || !S_ISREG(status->st_mode))
    return fail(ErrorCode::Unreadable, "cannot read the file: it is not a regular file",
                file.string());
  return OpenFile(file.string(), *std::move(opened), *status);
}

std::uint64_t OpenFile::size() const { return static_cast<std::uint64_t>(status_.st_size); }

std::string OpenFile::identity() const {
  return fmt::format("{}:{}", status_.st_dev, status_.st_ino);
}

std::string OpenFile::stamp() const {
  return fmt::format("{} {} {} {}.{} {}.{}", status_.st_dev, status_.st_ino, status_.st_size,
                     status_.st_mtim.tv_sec, status_.st_mtim.tv_nsec, status_.st_ctim.tv_sec,
                     status_.st_ctim.tv_nsec);
}

Result<fs::path> find_below(const fs::path& file, const fs::path& root) {
  if (root.empty()) return file;
  const auto walk = walk_below(file, root);
  if (!walk) return fail(walk.error());
  return walk->real();
}

}  // namespace pliant
