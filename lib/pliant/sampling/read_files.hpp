#pragma once

#include <string>
#include <vector>

#include "pliant/scene/inputs.hpp"

namespace pliant {

/// The files that something on a shelf was read from. Internal to sampling.
class ReadFiles {
 public:
  ReadFiles() = default;

  /// Looks at them, before they are read: what changes meanwhile has changed.
  explicit ReadFiles(std::vector<SceneInput> files);

  /// Whether the system says that they are still the same.
  bool are_unchanged() const;

 private:
  std::vector<SceneInput> files_;
  std::vector<std::string> stamps_;  // one a file; empty: it cannot be opened
};

}  // namespace pliant
