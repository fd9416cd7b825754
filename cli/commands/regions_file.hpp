#pragma once

#include <filesystem>
#include <string>

#include "pliant/files/atomic_file.hpp"
#include "pliant/pliant.hpp"

namespace pliant::cli {

/// The regions solved in each frame and their forces, as JSON; docs/regions.md. Written frame by
/// frame; appears under its name when finished.
class RegionsFile {
 public:
  /// Errors: Unwritable.
  static Result<RegionsFile> create(const std::filesystem::path& file, const Scene& scene);

  /// Appends a frame. Errors: Unwritable.
  Result<void> write(const FrameReport& report, const Simulation& simulation);

  /// Ends the file with the counts of the solvers' work. Errors: Unwritable.
  Result<void> finish(const SolverCounts& counts);

 private:
  explicit RegionsFile(AtomicFile file) : file_(std::move(file)) {}

  AtomicFile file_;
  bool is_first_ = true;
};

}  // namespace pliant::cli
