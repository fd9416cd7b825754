#include <functional>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/files/formats.hpp"
#include "pliant/files/usd/usda_names.hpp"
#include "pliant/files/usd/usda_surface.hpp"
#include "pliant/files/writer.hpp"
#include "pliant/files/written_mesh.hpp"

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

// The materials named by faces, and that of colliders, as prims that a program can shade.
class MaterialScope {
 public:
  explicit MaterialScope(std::string scope) : scope_(std::move(scope)) {}

  // Null: that of colliders.
  std::string path_of(const std::string* name) {
    Material material{name ? *name : "collider", {}, name == nullptr};
    const auto [place, is_new] =
        numbers_.try_emplace({material.is_of_colliders, material.name}, materials_.size());
    if (is_new) {
      material.prim = names_.take(material.name);
      materials_.push_back(std::move(material));
    }
    return path(materials_[place->second].prim);
  }

  std::string text() const {
    if (materials_.empty()) return {};
    std::string text = fmt::format("\n    def Scope \"{}\"\n    {{\n", scope_);
    for (const auto& [name, prim, is_of_colliders] : materials_) {
      text += fmt::format("        def Material \"{}\"", prim);
      if (prim != name)
        text += fmt::format(" (\n            displayName = {}\n        )", usda_string(name));
      text += fmt::format(
          "\n        {{\n            token outputs:surface.connect = "
          "<{0}/surface.outputs:surface>\n\n            def Shader \"surface\"\n            {{\n"
          "                uniform token info:id = \"UsdPreviewSurface\"\n{1}"
          "                float inputs:roughness = 0.7\n"
          "                token outputs:surface\n            }}\n        }}\n",
          path(prim),
          is_of_colliders
              ? fmt::format("                color3f inputs:diffuseColor = ({0}, {0}, {0})\n",
                            collider_grey)
              : "");
    }
    return text + "    }\n";
  }

 private:
  struct Material {
    std::string name, prim;
    bool is_of_colliders;
  };

  std::string path(const std::string& prim) const { return "/scene/" + scope_ + '/' + prim; }

  std::string scope_;
  UsdaNames names_;
  std::vector<Material> materials_;
  std::map<std::pair<bool, std::string>, std::size_t> numbers_;  // of the colliders', by its name
};

class UsdaWriter final : public AnimationWriter {
 public:
  UsdaWriter(AtomicFile file, std::vector<UsdaSurface> things)
      : file_(std::move(file)), things_(std::move(things)) {}

  Result<void> write(int frame, std::span<const SurfacePose> surfaces,
                     std::span<const SurfacePose> colliders) override {
    return add_poses(things_, surfaces, colliders,
                     [&](auto& thing, const SurfacePose& pose) { return thing.add(pose, frame); });
  }

  Result<void> finish() override {
    UsdaNames names;
    std::vector<std::string> prims;
    for (const UsdaSurface& thing : things_) prims.push_back(names.take(thing.name()));
    MaterialScope materials(names.take("materials"));
    for (std::size_t k = 0; k < things_.size(); ++k) {
      auto written = things_[k].write(
          prims[k], [&](const std::string* name) { return materials.path_of(name); }, file_);
      if (!written) return written;
    }
    if (auto written = file_.write(materials.text() + "}\n"); !written) return written;
    return file_.commit();
  }

 private:
  AtomicFile file_;
  std::vector<UsdaSurface> things_;  // surfaces, then colliders
};

}  // namespace

Result<std::unique_ptr<AnimationWriter>> make_usda_writer(const AnimationPlan& plan) {
  auto file = AtomicFile::create(plan.file);
  if (!file) return fail(file.error());
  if (auto written = file->write(layer_head(plan)); !written) return fail(written.error());
  std::vector<UsdaSurface> things;
  const auto add = [&](const AnimatedSurface& surface, WrittenAs as) -> Result<void> {
    auto made = UsdaSurface::make(plan, surface, as);
    if (!made) return fail(made.error());
    things.push_back(*std::move(made));
    return {};
  };
  if (auto added = add_things(plan, add); !added) return fail(added.error());
  return std::make_unique<UsdaWriter>(*std::move(file), std::move(things));
}

}  // namespace pliant
