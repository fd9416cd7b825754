#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/core/hash_stream.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/files/byte_sink.hpp"
#include "pliant/files/formats.hpp"
#include "pliant/files/gltf/glb.hpp"
#include "pliant/files/gltf/gltf_numbers.hpp"
#include "pliant/files/gltf/gltf_spool.hpp"
#include "pliant/files/gltf/gltf_surface.hpp"
#include "pliant/files/open_folder.hpp"
#include "pliant/files/output_place.hpp"
#include "pliant/files/single_precision.hpp"
#include "pliant/files/spool_file.hpp"

namespace pliant {
namespace {

using Json = GltfBuffer::Json;

// A file name as a URI reference in JSON: RFC 3986 requires all other characters to be escaped.
std::string to_uri(const std::string& name) {
  std::string uri;
  for (const char c : name) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                          (c >= '0' && c <= '9') || c == '-' || c == '.' || c == '_' || c == '~';
    uri += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri;
}

// The materials named by faces, one without a name for faces without one, and that of colliders.
// Sheets are visible from both sides.
class Materials {
 public:
  /// Null: that of colliders.
  std::size_t index_of(const std::string* name) {
    const auto [place, is_new] =
        numbers_.try_emplace({name == nullptr, name ? *name : "collider"}, keys_.size());
    if (is_new) keys_.push_back(place->first);
    return place->second;
  }

  Json json() const {
    Json materials = Json::array();
    for (const auto& [is_collider, name] : keys_) {
      Json material = Json::object();
      if (!name.empty()) material["name"] = name;
      material["pbrMetallicRoughness"] = {{"metallicFactor", 0}, {"roughnessFactor", 0.7}};
      if (is_collider) {
        material["pbrMetallicRoughness"]["baseColorFactor"] = {collider_grey, collider_grey,
                                                               collider_grey, 1};
      } else {
        material["doubleSided"] = true;
      }
      materials.push_back(std::move(material));
    }
    return materials;
  }

 private:
  using Key = std::pair<bool, std::string>;  // whether it is that of colliders, and its name

  std::vector<Key> keys_;
  std::map<Key, std::size_t> numbers_;
};

class GltfWriter final : public AnimationWriter {
 public:
  GltfWriter(const AnimationPlan& plan, std::optional<AtomicFile> separate,
             std::optional<SpoolFile> spool)
      : file_(plan.file),
        separate_(std::move(separate)),
        spool_(std::move(spool)),
        should_stop_(plan.should_stop),
        buffer_(
            [this](std::string_view bytes) {
              return write_in_pieces(bytes, should_stop_,
                                     [this](std::string_view piece) { return take(piece); });
            },
            should_stop_) {
    for (int k = 0; k < plan.frame_count(); ++k) times_.push_back(static_cast<float>(k / plan.fps));
  }

  Result<void> begin(const AnimationPlan& plan) {
    const auto add = [&](const AnimatedSurface& surface, WrittenAs as) -> Result<void> {
      auto made = GltfSurface::make(surface, as, should_stop_);
      if (!made) return fail(made.error());
      things_.push_back(*std::move(made));
      return things_.back().begin(surface.rest, plan.first_frame, buffer_);
    };
    return add_things(plan, add);
  }

  Result<void> write(int frame, std::span<const SurfacePose> surfaces,
                     std::span<const SurfacePose> colliders) override {
    return add_poses(things_, surfaces, colliders, [&](auto& thing, const SurfacePose& pose) {
      return thing.add(pose, frame, buffer_);
    });
  }

  Result<void> finish() override {
    const auto json = document();
    if (!json) return fail(json.error());
    // Bytes in a name that are not UTF-8 become a replacement character.
    const std::string text = json->dump(-1, ' ', false, Json::error_handler_t::replace);
    return separate_ ? write_gltf(text) : write_glb(text);
  }

 private:
  Result<void> take(std::string_view bytes) {
    if (separate_) {
      separate_hash_.add(bytes);
      return separate_->write(bytes);
    }
    if (spool_->size() + bytes.size() > most_glb_bytes) return too_large();
    return spool_->write(bytes);
  }

  tl::unexpected<Error> too_large() const {
    return fail(ErrorCode::Unwritable,
                "the animation is larger than the 4 GiB that a .glb can store; .gltf, .usda, .pc2, "
                ".mdd and .npy can store more",
                file_.string());
  }

  Result<Json> document() {
    Json root = {{"asset", {{"version", "2.0"}, {"generator", "pliant"}}}, {"scene", 0}};
    Json scene = {{"nodes", Json::array()}};
    Json nodes = Json::array(), meshes = Json::array();
    Materials materials;
    for (std::size_t k = 0; k < things_.size(); ++k) {
      scene["nodes"].push_back(k);
      nodes.push_back(things_[k].node(k));
      meshes.push_back(
          things_[k].mesh([&](const std::string* name) { return materials.index_of(name); }));
    }
    const bool is_animated =
        std::any_of(things_.begin(), things_.end(),
                    [](const GltfSurface& surface) { return surface.is_animated(); });
    if (is_animated) {
      auto animation = make_animation();
      if (!animation) return fail(animation.error());
      root["animations"] = Json::array({*std::move(animation)});
    }
    root["scenes"] = Json::array({std::move(scene)});
    root["nodes"] = std::move(nodes);
    root["meshes"] = std::move(meshes);
    root["materials"] = materials.json();
    root["accessors"] = buffer_.accessors();
    root["bufferViews"] = buffer_.views();
    Json buffer = {{"byteLength", buffer_.size()}};
    if (separate_) buffer["uri"] = to_uri(separate_name().filename().string());
    root["buffers"] = Json::array({std::move(buffer)});
    return root;
  }

  Result<Json> make_animation() {
    Json animation = {{"name", "bake"}, {"channels", Json::array()}, {"samplers", Json::array()}};
    const auto times = buffer_.add_keys(times_, 1, GltfBuffer::Bounds::Written);
    if (!times) return fail(times.error());
    for (std::size_t k = 0; k < things_.size(); ++k) {
      if (auto animated = things_[k].animate(k, *times, buffer_, animation); !animated)
        return fail(animated.error());
    }
    return animation;
  }

  // Requires: all numbers are written.
  std::filesystem::path separate_name() const { return numbers_file(file_, separate_hash_.hash()); }

  // The numbers first, under a name of their own: an older .gltf keeps its numbers until the new
  // one replaces it, in one step.
  Result<void> write_gltf(const std::string& text) {
    auto file = AtomicFile::create(file_);
    if (!file) return fail(file.error());
    if (auto written = file->write(text); !written) return written;
    // Another bake with this name must not change the .gltf between our look at it and our rename.
    const OpenFolder folder(file_);
    folder.lock();
    std::vector<std::filesystem::path> unused = numbers_named_by(file_);
    const std::filesystem::path numbers = separate_name();
    std::error_code unknown;
    const bool is_own = !std::filesystem::exists(numbers, unknown) && !unknown;
    auto committed = separate_->commit_as(numbers);
    if (committed) {
      committed = file->commit();
      if (!committed && is_own) unused.push_back(numbers);
    }
    remove_unnamed_numbers(file_, std::move(unused));
    return committed;
  }

  Result<void> write_glb(const std::string& text) {
    const auto head = glb_head(text, spool_->size());
    if (!head) return too_large();
    auto file = AtomicFile::create(file_);
    if (!file) return fail(file.error());
    if (auto written = file->write(*head); !written) return written;
    if (auto copied = spool_->copy_to(*file, should_stop_); !copied) return copied;
    return file->commit();
  }

  std::filesystem::path file_;
  std::optional<AtomicFile> separate_;  // the numbers of a .gltf
  HashStream separate_hash_;            // of the bytes in `separate_`
  std::optional<SpoolFile> spool_;      // the numbers of a .glb until they can be written
  StopRequest should_stop_;
  GltfBuffer buffer_;
  std::vector<GltfSurface> things_;  // surfaces, then colliders
  std::vector<float> times_;
};

}  // namespace

Result<std::unique_ptr<AnimationWriter>> make_gltf_writer(const AnimationPlan& plan) {
  if (plan.frame_count() > most_gltf_frames) {
    return fail(ErrorCode::InvalidInput,
                fmt::format("{}: glTF stores a weight of each frame at each frame, which is too "
                            "much for {} frames; at most {} are allowed; use .usda, .pc2, .mdd or "
                            ".npy, or choose fewer frames with --frames",
                            plan.file, plan.frame_count(), most_gltf_frames));
  }
  if (auto last = to_single_seconds(plan.frame_count(), plan.fps); !last) return fail(last.error());
  const bool is_separate = ending_of(plan.file) == ".gltf";
  if (is_separate) {
    if (auto place = check_output_place(numbers_file(plan.file, {})); !place)
      return fail(place.error());
  }
  // An unwritable file must be reported before a long run.
  if (auto probe = AtomicFile::create(plan.file); !probe) return fail(probe.error());
  std::optional<AtomicFile> separate;
  std::optional<SpoolFile> spool;
  if (is_separate) {
    auto file = AtomicFile::create(plan.file);  // its name is known only at the end
    if (!file) return fail(file.error());
    separate.emplace(*std::move(file));
  } else {
    auto file = SpoolFile::create(plan.file);
    if (!file) return fail(file.error());
    spool.emplace(*std::move(file));
  }
  auto writer = std::make_unique<GltfWriter>(plan, std::move(separate), std::move(spool));
  if (auto begun = writer->begin(plan); !begun) return fail(begun.error());
  return writer;
}

}  // namespace pliant
