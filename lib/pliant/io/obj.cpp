#include "pliant/io/obj.hpp"

#include <cstdlib>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "pliant/io/atomic_file.hpp"

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

std::filesystem::path sequence_file(const std::filesystem::path& pattern, int frame) {
  std::string name = pattern.filename().string();
  std::size_t last = name.rfind('#');
  std::size_t width = 4;
  if (last == std::string::npos) {
    const std::size_t dot = name.rfind('.');
    name.insert(dot, ".#");
    last = dot + 1;
  } else {
    width = last + 1 - (name.find_last_not_of('#', last) + 1);
  }
  const std::size_t first = name.find_last_not_of('#', last) + 1;
  name.replace(first, last + 1 - first,
               fmt::format("{}{:0{}}", frame < 0 ? "-" : "", std::abs(std::int64_t{frame}), width));
  return pattern.parent_path() / name;
}

Result<std::unique_ptr<AnimationWriter>> make_obj_writer(const AnimationPlan& plan) {
  // A folder that cannot be written to should not show only after a long run.
  if (auto probe = AtomicFile::create(sequence_file(plan.file, plan.first_frame)); !probe) {
    return fail(probe.error());
  }
  return std::make_unique<ObjWriter>(plan);
}

}  // namespace pliant
