#include <array>
#include <optional>
#include <utility>

#include "pliant/files/formats.hpp"
#include "pliant/files/obj/obj_text.hpp"
#include "pliant/files/sequence.hpp"
#include "pliant/files/written_mesh.hpp"

namespace pliant {
namespace {

class ObjWriter final : public SequenceWriter {
 public:
  explicit ObjWriter(const SurfacePlan& plan) : SequenceWriter(plan), mesh_(*plan.mesh) {}

 private:
  Result<void> write_frame(const SurfacePose& pose, const ByteSink& sink) override {
    std::optional<ObjText>& text = texts_[pose.is_mirrored ? 1 : 0];
    if (!text) {
      auto made = ObjText::make(mesh_.in_space(pose.is_mirrored), should_stop());
      if (!made) return fail(made.error());
      text.emplace(*std::move(made));
    }
    return text->write(pose.positions, sink, should_stop());
  }

  WrittenMesh mesh_;
  std::array<std::optional<ObjText>, 2> texts_;  // that of a mirrored space second
};

}  // namespace

Result<std::unique_ptr<SurfaceWriter>> make_obj_writer(const SurfacePlan& plan) {
  if (auto checked = check_sequence(plan); !checked) return fail(checked.error());
  return std::make_unique<ObjWriter>(plan);
}

}  // namespace pliant
