#include "pliant/io/obj.hpp"

#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "pliant/io/atomic_file.hpp"
#include "pliant/io/sequence.hpp"

namespace pliant {
namespace {

class ObjWriter final : public AnimationWriter {
 public:
  explicit ObjWriter(const AnimationPlan& plan) : pattern_(plan.file) {
    // Everything but the positions is the same in every frame.
    const Mesh& mesh = *plan.mesh;
    auto out = std::back_inserter(topology_);
    for (const auto& [u, v] : mesh.uvs) fmt::format_to(out, "vt {} {}\n", u, v);
    std::size_t corner = 0;
    for (const int size : mesh.face_sizes) {
      topology_ += 'f';
      for (int k = 0; k < size; ++k, ++corner) {
        const int vertex = mesh.corner_vertices[corner] + 1;
        const int uv = mesh.corner_uvs[corner] + 1;
        if (uv > 0) {
          fmt::format_to(out, " {}/{}", vertex, uv);
        } else {
          fmt::format_to(out, " {}", vertex);
        }
      }
      topology_ += '\n';
    }
  }

  Result<void> write(int frame, const Field& positions) override {
    auto file = AtomicFile::create(sequence_file(pattern_, frame));
    if (!file) return fail(file.error());
    vertices_.clear();
    auto out = std::back_inserter(vertices_);
    for (Eigen::Index row = 0; row < positions.rows(); ++row) {
      fmt::format_to(out, "v {} {} {}\n", positions(row, 0), positions(row, 1), positions(row, 2));
    }
    if (auto written = file->write(vertices_); !written) return written;
    if (auto written = file->write(topology_); !written) return written;
    return file->commit();
  }

  Result<void> finish() override { return {}; }

 private:
  std::filesystem::path pattern_;
  std::string topology_;
  std::string vertices_;
};

}  // namespace

Result<std::unique_ptr<AnimationWriter>> make_obj_writer(const AnimationPlan& plan) {
  if (auto checked = check_sequence(plan); !checked) return fail(checked.error());
  return std::make_unique<ObjWriter>(plan);
}

}  // namespace pliant
