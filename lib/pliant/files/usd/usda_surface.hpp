#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pliant/files/atomic_file.hpp"
#include "pliant/files/byte_sink.hpp"
#include "pliant/files/spool_file.hpp"
#include "pliant/files/writer.hpp"
#include "pliant/files/written_mesh.hpp"

namespace pliant {

// One surface or collider of a USD file: collects the samples of each attribute until they can be
// written. Internal to files.
class UsdaSurface {
 public:
  // Errors: Unwritable; Interrupted.
  static Result<UsdaSurface> make(const AnimationPlan& plan, const AnimatedSurface& surface,
                                  WrittenAs as);

  // Errors: Unwritable; NotFinite; Interrupted.
  Result<void> add(const SurfacePose& pose, int frame);

  // Writes the prim with the given name. `material_path` returns the path of a material's prim by
  // its name; null: of that of colliders. Errors: Unwritable; Interrupted.
  Result<void> write(const std::string& name,
                     const std::function<std::string(const std::string*)>& material_path,
                     AtomicFile& file);

  const Mesh& mesh() const { return *mesh_; }
  const std::string& name() const { return name_; }

 private:
  // The samples of one part of a placement, as text.
  struct Operation {
    std::string type, name;
    std::vector<std::string> samples = {};
  };

  UsdaSurface(const AnimationPlan& plan, const AnimatedSurface& surface, WrittenAs as,
              SpoolFile points, SpoolFile normals, SpoolFile velocities);

  Result<void> add_pose(const Field& positions, int frame);
  Result<void> add_sample(SpoolFile& samples, int frame, std::span<const float> numbers);
  Result<void> add_velocities(int frame, const Field& way);
  void add_placement(const Placement& placement);
  std::string head(const std::string& name) const;
  Result<void> add_topology(TextPieces& out) const;
  Result<void> add_uvs(TextPieces& out) const;
  std::string samples_of(const Operation& operation) const;
  std::string placement() const;
  Result<void> add_subsets(const std::function<std::string(const std::string*)>& material_path,
                           TextPieces& out) const;

  std::string name_;
  WrittenMesh written_;
  const Mesh* mesh_;
  int first_frame_;
  int last_frame_;
  double fps_;
  WrittenAs as_;
  StopRequest should_stop_;
  std::string rest_;     // points at rest
  std::string extents_;  // samples
  SpoolFile points_, normals_, velocities_;
  std::optional<Field> last_;     // positions of the last frame
  bool is_last_written_ = false;  // of a collider
  std::vector<Operation> operations_;
  Operation visibility_ = {"token", "visibility"};  // of a collider
};

}  // namespace pliant
