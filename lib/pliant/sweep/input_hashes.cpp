#include "pliant/sweep/input_hashes.hpp"

#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <sys/stat.h>

#include "pliant/core/hash_stream.hpp"
#include "pliant/core/read_file.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/scene/inputs.hpp"

namespace pliant {
namespace {

Result<Hash> hash_of_file(const std::string& file, const StopRequest& should_stop) {
  HashStream stream;
  bool is_stopped = false;
  const auto read = read_pieces(file, [&](std::string_view piece) {
    stream.add(piece);
    is_stopped = pliant::is_stopped(should_stop);
    return !is_stopped;
  });
  if (!read) return fail(read.error());
  if (is_stopped) return interrupted();
  return stream.hash();
}

// Changes whenever the file does, as far as the system knows; empty: there is none. A pipe or a
// device is no input that can be read again.
std::string stamp_of(const std::string& file) {
  struct stat found = {};
  if (stat(file.c_str(), &found) != 0 || !S_ISREG(found.st_mode)) return {};
  return fmt::format("{} {} {} {}.{} {}.{}", found.st_dev, found.st_ino, found.st_size,
                     found.st_mtim.tv_sec, found.st_mtim.tv_nsec, found.st_ctim.tv_sec,
                     found.st_ctim.tv_nsec);
}

// All that decides which files a scene leads to, beside its own text.
std::vector<std::string> names_in(const Scene& scene) {
  std::vector<std::string> names;
  for (const Surface& surface : scene.surfaces) {
    names.push_back(surface.cache.path);
    for (const MaterialMap& map : surface.maps) names.push_back(map.file);
    const auto* const mesh = std::get_if<MeshFile>(&surface.shape);
    names.push_back(mesh ? mesh->path : "");
    names.push_back(mesh ? mesh->root : "");
  }
  return names;
}

}  // namespace

InputHashes::InputHashes(std::vector<InputHash> files) {
  for (InputHash& input : files) files_[std::move(input.file)] = {input.hash};
}

InputHashes::InputHashes(InputHashes&& other) noexcept
    : files_(std::move(other.files_)), inputs_(std::move(other.inputs_)) {}

const std::vector<std::string>& InputHashes::files_of(const Scene& scene) {
  const auto [found, is_new] = inputs_.try_emplace(names_in(scene));
  if (!is_new) return found->second;
  for (const SceneInput& input : inputs_of(scene)) {
    const bool is_text =
        input.role == "the scene" || input.role == "a file that the scene includes";
    if (!is_text) found->second.push_back(input.file.string());
  }
  return found->second;
}

Result<void> InputHashes::add(const Scene& scene, const StopRequest& should_stop) {
  if (is_stopped(should_stop)) return interrupted();
  const std::lock_guard lock(mutex_);
  for (const std::string& file : files_of(scene)) {
    if (files_.contains(file)) continue;
    std::string stamp = stamp_of(file);
    if (stamp.empty()) continue;
    const auto hash = hash_of_file(file, should_stop);
    if (hash) files_[file] = {*hash, std::move(stamp)};
    if (!hash && hash.error().code == ErrorCode::Interrupted) return fail(hash.error());
  }
  return {};
}

std::vector<InputHash> InputHashes::all() const {
  std::vector<InputHash> all;
  for (const auto& [file, known] : files_) all.push_back({file, known.hash});
  return all;
}

Result<void> InputHashes::check(const Scene& scene, const StopRequest& should_stop) {
  const std::lock_guard lock(mutex_);
  const auto refuse = [](const std::string& file, std::string_view reason) {
    return fail(ErrorCode::Unreadable, fmt::format("{} {}", printable(file), reason));
  };
  for (const std::string& file : files_of(scene)) {
    const auto known = files_.find(file);
    if (known == files_.end()) return refuse(file, "could not be read when the sweep was made");
    std::string stamp = stamp_of(file);
    if (stamp.empty()) return refuse(file, "is gone");
    if (stamp == known->second.stamp) continue;
    const auto hash = hash_of_file(file, should_stop);
    if (!hash && hash.error().code == ErrorCode::Interrupted) return fail(hash.error());
    if (!hash) return refuse(file, "cannot be read");
    if (*hash != known->second.hash) return refuse(file, "has changed since the sweep was made");
    known->second.stamp = std::move(stamp);
  }
  return {};
}

}  // namespace pliant
