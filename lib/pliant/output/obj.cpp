#include "pliant/output/formats.hpp"
#include "pliant/output/obj_text.hpp"
#include "pliant/output/sequence.hpp"

namespace pliant {
namespace {

class ObjWriter final : public SequenceWriter {
 public:
  explicit ObjWriter(const SurfacePlan& plan) : SequenceWriter(plan), text_(*plan.mesh) {}

 private:
  Result<void> write_frame(const Field& positions, const ByteSink& sink) override {
    return text_.write(positions, sink);
  }

  ObjText text_;
};

}  // namespace

Result<std::unique_ptr<SurfaceWriter>> make_obj_writer(const SurfacePlan& plan) {
  if (auto checked = check_sequence(plan); !checked) return fail(checked.error());
  return std::make_unique<ObjWriter>(plan);
}

}  // namespace pliant
