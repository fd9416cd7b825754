#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "pliant/core/hash.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/scene/inputs.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// A file that scenes lead to, with the hash of its bytes. Internal to sweep.
struct InputHash {
  std::string file;
  Hash hash;
};

/// The files of meshes, caches and maps as they were when a sweep was made. Thread-safe. Internal
/// to sweep.
class InputHashes {
 public:
  explicit InputHashes(std::vector<InputHash> files = {});
  InputHashes(InputHashes&& other) noexcept;
  InputHashes& operator=(InputHashes&&) = delete;

  /// Reads and adds the files of a scene; those that cannot be read are left out.
  /// Errors: Interrupted.
  Result<void> add(const Scene& scene, const StopRequest& should_stop = {});

  std::vector<InputHash> all() const;

  /// Checks that the files of a scene are those of the sweep. A file is read again only if its
  /// size, its number or a time of it has changed. Errors: Unreadable, naming the file: it has
  /// changed, is gone, or could not be read when the sweep was made.
  /// Interrupted.
  Result<void> check(const Scene& scene, const StopRequest& should_stop = {});

 private:
  struct Known {
    Hash hash;
    std::string stamp = {};  // what the system said of the file when its hash was right; empty: not
                             // looked at yet
  };

  const std::vector<SceneInput>& files_of(const Scene& scene);

  std::mutex mutex_;
  std::map<std::string, Known> files_;
  std::map<std::vector<std::string>, std::vector<SceneInput>> inputs_;  // by what a scene names
};

}  // namespace pliant
