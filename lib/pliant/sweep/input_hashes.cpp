#include "pliant/sweep/input_hashes.hpp"

#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "pliant/core/stop_request.hpp"
#include "pliant/files/open_file.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/scene/inputs.hpp"

namespace pliant {
namespace {

// All that decides which files a scene leads to, beside its own text.
std::vector<std::string> names_in(const Scene& scene) {
  std::vector<std::string> names;
  for (const Surface& surface : scene.surfaces) {
    names.push_back(surface.cache.path);
    for (const MaterialMap& map : surface.maps) names.push_back(map.file);
    for (const Hold& hold : surface.holds) names.push_back(hold.file);
    const auto* const mesh = std::get_if<MeshFile>(&surface.shape);
    names.push_back(mesh ? mesh->path : "");
    names.push_back(mesh ? mesh->root : "");
  }
  for (const Collider& collider : scene.colliders) {
    const auto* const closed = std::get_if<ClosedMesh>(&collider.shape);
    names.push_back(closed ? closed->cache.path : "");
    names.push_back(closed ? closed->mesh.path : "");
    names.push_back(closed ? closed->mesh.root : "");
  }
  return names;
}

}  // namespace

InputHashes::InputHashes(std::vector<InputHash> files) {
  for (InputHash& input : files) files_[std::move(input.file)] = {input.hash};
}

InputHashes::InputHashes(InputHashes&& other) noexcept
    : files_(std::move(other.files_)), inputs_(std::move(other.inputs_)) {}

const std::vector<SceneInput>& InputHashes::files_of(const Scene& scene) {
  const auto [found, is_new] = inputs_.try_emplace(names_in(scene));
  if (!is_new) return found->second;
  for (SceneInput& input : inputs_of(scene)) {
    const bool is_text =
        input.role == "the scene" || input.role == "a file that the scene includes";
    if (!is_text) found->second.push_back(std::move(input));
  }
  return found->second;
}

Result<void> InputHashes::add(const Scene& scene, const StopRequest& should_stop) {
  if (is_stopped(should_stop)) return interrupted();
  const std::lock_guard lock(mutex_);
  for (const SceneInput& input : files_of(scene)) {
    const std::string file = input.file.string();
    if (files_.contains(file)) continue;
    // A pipe or a device is no input that can be read again.
    const auto opened = OpenFile::open(file, input.root);
    if (!opened) continue;
    const auto hash = hash_of_file(*opened, should_stop);
    if (hash) files_[file] = {*hash, opened->stamp()};
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
  for (const SceneInput& input : files_of(scene)) {
    const std::string file = input.file.string();
    const auto known = files_.find(file);
    if (known == files_.end()) return refuse(file, "could not be read when the sweep was made");
    const auto opened = OpenFile::open(file, input.root);
    if (!opened) {
      const bool is_outside = opened.error().code == ErrorCode::InvalidInput;
      std::error_code unknown;
      const bool is_gone = !is_outside && !std::filesystem::is_regular_file(file, unknown);
      return refuse(file, is_gone ? "is gone" : "cannot be read");
    }
    std::string stamp = opened->stamp();
    if (stamp == known->second.stamp) continue;
    const auto hash = hash_of_file(*opened, should_stop);
    if (!hash && hash.error().code == ErrorCode::Interrupted) return fail(hash.error());
    if (!hash) return refuse(file, "cannot be read");
    if (*hash != known->second.hash) return refuse(file, "has changed since the sweep was made");
    known->second.stamp = std::move(stamp);
  }
  return {};
}

}  // namespace pliant
