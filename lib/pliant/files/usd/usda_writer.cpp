#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/files/formats.hpp"
#include "pliant/files/usd/usda_names.hpp"
#include "pliant/files/usd/usda_surface.hpp"

namespace pliant {
namespace {

std::string layer_head(const AnimationPlan& plan) {
  return fmt::format(
      "#usda 1.0\n(\n    defaultPrim = \"scene\"\n    doc = \"pliant\"\n    endTimeCode = {}\n"
      "    framesPerSecond = {}\n    metersPerUnit = 1\n    startTimeCode = {}\n"
      "    timeCodesPerSecond = {}\n    upAxis = \"Y\"\n)\n\ndef Xform \"scene\" (\n"
      "    kind = \"component\"\n)\n{{\n",
      plan.last_frame, plan.fps, plan.first_frame, plan.fps);
}

// The materials named by faces, as prims that a program can shade.
class MaterialScope {
 public:
  explicit MaterialScope(std::string scope) : scope_(std::move(scope)) {}

  std::string path_of(const std::string& name) {
    const auto [place, is_new] = numbers_.try_emplace(name, prims_.size());
    if (is_new) prims_.emplace_back(name, names_.take(name));
    return path(prims_[place->second].second);
  }

  std::string text() const {
    if (prims_.empty()) return {};
    std::string text = fmt::format("\n    def Scope \"{}\"\n    {{\n", scope_);
    for (const auto& [name, prim] : prims_) {
      text += fmt::format("        def Material \"{}\"", prim);
      if (prim != name)
        text += fmt::format(" (\n            displayName = {}\n        )", usda_string(name));
      text += fmt::format(
          "\n        {{\n            token outputs:surface.connect = "
          "<{0}/surface.outputs:surface>\n\n            def Shader \"surface\"\n            {{\n"
          "                uniform token info:id = \"UsdPreviewSurface\"\n"
          "                float inputs:roughness = 0.7\n"
          "                token outputs:surface\n            }}\n        }}\n",
          path(prim));
    }
    return text + "    }\n";
  }

 private:
  std::string path(const std::string& prim) const { return "/scene/" + scope_ + '/' + prim; }

  std::string scope_;
  UsdaNames names_;
  std::vector<std::pair<std::string, std::string>> prims_;   // name, prim
  std::map<std::string, std::size_t, std::less<>> numbers_;  // of the prims by their names
};

class UsdaWriter final : public AnimationWriter {
 public:
  UsdaWriter(AtomicFile file, std::vector<UsdaSurface> surfaces)
      : file_(std::move(file)), surfaces_(std::move(surfaces)) {}

  Result<void> write(int frame, std::span<const SurfacePose> surfaces) override {
    PLIANT_EXPECTS(surfaces.size() == surfaces_.size());
    for (std::size_t k = 0; k < surfaces.size(); ++k) {
      if (auto added = surfaces_[k].add(surfaces[k], frame); !added) return added;
    }
    return {};
  }

  Result<void> finish() override {
    UsdaNames names;
    std::vector<std::string> prims;
    for (const UsdaSurface& surface : surfaces_) prims.push_back(names.take(surface.name()));
    MaterialScope materials(names.take("materials"));
    for (std::size_t k = 0; k < surfaces_.size(); ++k) {
      auto written = surfaces_[k].write(
          prims[k], [&](const std::string& name) { return materials.path_of(name); }, file_);
      if (!written) return written;
    }
    if (auto written = file_.write(materials.text() + "}\n"); !written) return written;
    return file_.commit();
  }

 private:
  AtomicFile file_;
  std::vector<UsdaSurface> surfaces_;
};

}  // namespace

Result<std::unique_ptr<AnimationWriter>> make_usda_writer(const AnimationPlan& plan) {
  auto file = AtomicFile::create(plan.file);
  if (!file) return fail(file.error());
  if (auto written = file->write(layer_head(plan)); !written) return fail(written.error());
  std::vector<UsdaSurface> surfaces;
  for (const AnimatedSurface& surface : plan.surfaces) {
    auto made = UsdaSurface::make(plan, surface);
    if (!made) return fail(made.error());
    surfaces.push_back(*std::move(made));
  }
  return std::make_unique<UsdaWriter>(*std::move(file), std::move(surfaces));
}

}  // namespace pliant
