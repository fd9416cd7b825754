#include "pliant/files/writer.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pliant/core/expects.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/formats.hpp"
#include "pliant/files/gltf/gltf_numbers.hpp"
#include "pliant/files/output_place.hpp"
#include "pliant/files/sequence.hpp"

namespace pliant {
namespace {

using MakeSurfaceWriter = Result<std::unique_ptr<SurfaceWriter>> (*)(const SurfacePlan&);
using MakeWriter = Result<std::unique_ptr<AnimationWriter>> (*)(const AnimationPlan&);

struct Format {
  std::string ending;
  bool is_sequence = false;
  bool is_single = false;                           // it has positions in single precision
  MakeSurfaceWriter make_surface_writer = nullptr;  // for a format of one surface
  MakeWriter make_writer = nullptr;                 // for a format of all surfaces
  std::string beside = {};  // ending of a second file with the same name, if any
};

constexpr double most_precision_loss = 1e-4;  // of the size of a surface

const std::vector<Format>& formats() {
  static const std::vector<Format> all = {
      {".npy", false, false, &make_npy_writer, nullptr},
      {".obj", true, false, &make_obj_writer, nullptr},
      {".ply", true, false, &make_ply_writer, nullptr},
      {".pc2", false, true, &make_pc2_writer, nullptr, ".obj"},
      {".mdd", false, true, &make_mdd_writer, nullptr, ".obj"},
      {".glb", false, true, nullptr, &make_gltf_writer},
      {".gltf", false, true, nullptr, &make_gltf_writer},
      {".usda", false, true, nullptr, &make_usda_writer},
  };
  return all;
}

const Format* find_format(const std::filesystem::path& file) {
  const std::string ending = ending_of(file);
  const auto found = std::find_if(formats().begin(), formats().end(),
                                  [&](const Format& format) { return format.ending == ending; });
  return found == formats().end() ? nullptr : &*found;
}

// OUT, or OUT-NAME.ext if there are several surfaces; NAME is inserted before the frame's place if
// OUT has one, so that it is still a sequence: x.###.obj becomes x-NAME.###.obj.
std::filesystem::path file_for(const AnimationPlan& plan, const std::string& surface) {
  std::filesystem::path file = plan.file;
  if (plan.surfaces.size() == 1) return file;
  std::string name = file.filename().string();
  const std::size_t frame = name.find('#');
  std::size_t place = frame == std::string::npos ? file.stem().string().size() : frame;
  if (frame != std::string::npos && place > 0 && name[place - 1] == '.') --place;
  return file.parent_path() / name.insert(place, '-' + surface);
}

// Passes each surface to a writer of its own.
class SurfaceBySurface final : public AnimationWriter {
 public:
  explicit SurfaceBySurface(std::vector<std::unique_ptr<SurfaceWriter>> writers)
      : writers_(std::move(writers)) {}

  Result<void> write(int frame, std::span<const SurfacePose> surfaces,
                     std::span<const SurfacePose>) override {
    PLIANT_EXPECTS(surfaces.size() == writers_.size());
    for (std::size_t k = 0; k < writers_.size(); ++k) {
      if (auto written = writers_[k]->write(frame, surfaces[k]); !written) return written;
    }
    return {};
  }

  Result<void> finish() override {
    for (const auto& writer : writers_) {
      if (auto finished = writer->finish(); !finished) return finished;
    }
    return {};
  }

  FileCounts file_counts() const override {
    FileCounts sum;
    for (const auto& writer : writers_) {
      const FileCounts counts = writer->file_counts();
      sum.kept += counts.kept;
      sum.written += counts.written;
    }
    return sum;
  }

 private:
  std::vector<std::unique_ptr<SurfaceWriter>> writers_;
};

Result<std::unique_ptr<AnimationWriter>> make_surface_by_surface(const AnimationPlan& plan,
                                                                 const Format& format) {
  std::vector<std::unique_ptr<SurfaceWriter>> writers;
  for (const AnimatedSurface& surface : plan.surfaces) {
    auto writer = format.make_surface_writer({.file = file_for(plan, surface.name),
                                              .mesh = surface.mesh,
                                              .first_frame = plan.first_frame,
                                              .last_frame = plan.last_frame,
                                              .fps = plan.fps,
                                              .rest = &surface.rest,
                                              .is_mirrored = surface.is_mirrored,
                                              .resume = plan.resume,
                                              .should_stop = plan.should_stop});
    if (!writer) return fail(writer.error());
    writers.push_back(*std::move(writer));
  }
  return std::make_unique<SurfaceBySurface>(std::move(writers));
}

}  // namespace

std::vector<std::string> known_endings() {
  std::vector<std::string> endings;
  for (const Format& format : formats()) endings.push_back(format.ending);
  return endings;
}

Result<void> check_ending(const std::string& file) {
  if (find_format(file)) return {};
  return fail(ErrorCode::InvalidInput,
              fmt::format("{}: no format has the ending \"{}\"; allowed: {}", file, ending_of(file),
                          fmt::join(known_endings(), ", ")));
}

bool contains_colliders(const std::string& file) {
  const Format* const format = find_format(file);
  PLIANT_EXPECTS(format);
  return format->make_writer != nullptr;
}

std::optional<PrecisionLoss> precision_loss_in(const Vector3d& low, const Vector3d& high) {
  constexpr double rounding = 0x1p-24;  // of a number, half a unit in the last place at most
  const double error = rounding * std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
  const double size = (high - low).norm();
  if (!(error > most_precision_loss * size)) return {};
  return PrecisionLoss{.error = error, .size = size, .centre = (low + high) / 2};
}

std::vector<PrecisionLoss> precision_losses(const AnimationPlan& plan) {
  const Format* const format = find_format(plan.file);
  PLIANT_EXPECTS(format);
  std::vector<PrecisionLoss> losses;
  for (std::size_t k = 0; format->is_single && k < plan.surfaces.size(); ++k) {
    const Field& rest = plan.surfaces[k].rest;
    const std::vector<int>& vertices = plan.surfaces[k].mesh->corner_vertices;
    Vector3d low = rest.row(vertices.front()).transpose(), high = low;
    for (const int vertex : vertices) {  // a vertex of no face is not seen
      low = low.cwiseMin(rest.row(vertex).transpose());
      high = high.cwiseMax(rest.row(vertex).transpose());
    }
    auto loss = precision_loss_in(low, high);
    if (!loss) continue;
    loss->surface = k;
    losses.push_back(*loss);
  }
  return losses;
}

std::vector<std::string> files_of(const AnimationPlan& plan) {
  const Format* const format = find_format(plan.file);
  PLIANT_EXPECTS(format);
  std::vector<std::string> files;
  const auto add = [&](const std::filesystem::path& file) {
    if (format->is_sequence) {
      for (std::int64_t frame = plan.first_frame; frame <= plan.last_frame; ++frame)
        files.push_back(sequence_file(file, static_cast<int>(frame)).string());
      return;
    }
    files.push_back(file.string());
    if (!format->beside.empty())
      files.push_back(std::filesystem::path(file).replace_extension(format->beside).string());
  };
  if (format->make_writer) {
    add(plan.file);
  } else {
    for (const AnimatedSurface& surface : plan.surfaces) add(file_for(plan, surface.name));
  }
  return files;
}

bool is_named_at_the_end(const AnimationPlan& plan, std::string_view name) {
  return ending_of(plan.file) == ".gltf" && is_numbers_file(plan.file, name);
}

Result<std::unique_ptr<AnimationWriter>> make_writer(const AnimationPlan& plan) {
  PLIANT_EXPECTS(!plan.surfaces.empty() && plan.first_frame <= plan.last_frame);
  if (auto known = check_ending(plan.file); !known) return fail(known.error());
  // A sequence checks its own files, which may be a million.
  if (!find_format(plan.file)->is_sequence) {
    for (const std::string& file : files_of(plan)) {
      if (auto place = check_output_place(file); !place) return fail(place.error());
    }
  }
  const Format& format = *find_format(plan.file);
  if (plan.resume && !format.is_sequence) {
    return fail(
        ErrorCode::InvalidInput,
        fmt::format(
            "{}: a {} is one file, which cannot be resumed; only a sequence of .obj or .ply can",
            plan.file, format.ending));
  }
  return format.make_writer ? format.make_writer(plan) : make_surface_by_surface(plan, format);
}

}  // namespace pliant
