#include <array>
#include <optional>
#include <utility>

#include "pliant/files/formats.hpp"
#include "pliant/files/ply/ply_bytes.hpp"
#include "pliant/files/sequence.hpp"
#include "pliant/files/written_mesh.hpp"

namespace pliant {
namespace {

class PlyWriter final : public SequenceWriter {
 public:
  explicit PlyWriter(const SurfacePlan& plan) : SequenceWriter(plan), mesh_(*plan.mesh) {}

 private:
  Result<void> write_frame(const SurfacePose& pose, const ByteSink& sink) override {
    std::optional<PlyBytes>& bytes = bytes_[pose.is_mirrored ? 1 : 0];
    if (!bytes) {
      auto made = PlyBytes::make(mesh_.in_space(pose.is_mirrored), PlyBytes::Content::Common,
                                 should_stop());
      if (!made) return fail(made.error());
      bytes.emplace(*std::move(made));
    }
    return bytes->write(pose.positions, sink, should_stop());
  }

  WrittenMesh mesh_;
  std::array<std::optional<PlyBytes>, 2> bytes_;  // that of a mirrored space second
};

}  // namespace

Result<std::unique_ptr<SurfaceWriter>> make_ply_writer(const SurfacePlan& plan) {
  if (auto checked = check_sequence(plan); !checked) return fail(checked.error());
  return std::make_unique<PlyWriter>(plan);
}

}  // namespace pliant
