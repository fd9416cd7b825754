#include "pliant/scene/scene_texts.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <utility>

#include "pliant/core/text.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/scene/elements/scene_file.hpp"
#include "pliant/scene/read.hpp"

namespace pliant {
namespace {

using Places = std::map<std::string, std::size_t, std::less<>>;  // of paths among the texts

// Files on the disk, which notes in `texts` what it finds.
xml::TextFiles noting(SceneTexts& texts, Places& places, const std::string& root,
                      const StopRequest& should_stop) {
  const xml::TextFiles disk = xml::files_on_disk(root, should_stop);
  return {.identify = [&, disk](const std::filesystem::path& path) -> Result<std::string> {
            auto identity = disk.identify(path);
            if (identity && places.emplace(path.string(), texts.included.size()).second)
              texts.included.push_back({path.string(), *identity});
            return identity;
          },
          .read = [&, disk](const std::filesystem::path& path,
                            std::size_t most_bytes) -> Result<std::string> {
            auto text = disk.read(path, most_bytes);
            const auto noted = places.find(path.string());
            if (text && noted != places.end()) texts.included[noted->second].text = *text;
            return text;
          }};
}

// The texts of `places`, which must outlive it.
xml::TextFiles among(const SceneTexts& texts, const Places& places) {
  const auto find = [&](const std::filesystem::path& path) -> Result<const IncludedText*> {
    const auto found = places.find(path.string());
    if (found == places.end())
      return fail(ErrorCode::Unreadable, "is not among the texts that are kept");
    return &texts.included[found->second];
  };
  const auto with = [find](std::string IncludedText::*member) {
    return [find, member](const std::filesystem::path& path, auto...) -> Result<std::string> {
      const auto found = find(path);
      if (!found) return fail(found.error());
      return (*found)->*member;
    };
  };
  return {.identify = with(&IncludedText::identity), .read = with(&IncludedText::text)};
}

}  // namespace

Result<LoadedScene> load_scene_with_texts(const std::string& file, const std::string& root,
                                          const StopRequest& should_stop) {
  auto text = read_file(file, largest_scene_file, should_stop);
  if (!text) return fail(text.error());
  SceneTexts texts{file, *std::move(text)};
  Places places;
  auto scene = xml::parse_scene_of(texts.text, file, folder_of_file(file), root,
                                   noting(texts, places, root, should_stop), should_stop);
  if (!scene) return fail(scene.error());
  return LoadedScene{*std::move(scene), std::move(texts)};
}

Result<Scene> parse_scene(const SceneTexts& texts, const std::string& root,
                          const StopRequest& should_stop) {
  Places places;
  for (std::size_t k = 0; k < texts.included.size(); ++k) places.emplace(texts.included[k].path, k);
  return xml::parse_scene_of(texts.text, texts.file, folder_of_file(texts.file), root,
                             among(texts, places), should_stop);
}

}  // namespace pliant
