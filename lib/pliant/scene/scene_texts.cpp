#include "pliant/scene/scene_texts.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "pliant/core/read_file.hpp"
#include "pliant/core/text.hpp"
#include "pliant/scene/read.hpp"
#include "pliant/scene/scene_file.hpp"

namespace pliant {
namespace {

// Files on the disk, which notes in `texts` what it finds.
xml::TextFiles noting(SceneTexts& texts, const std::string& root) {
  const xml::TextFiles disk = xml::files_on_disk(root);
  return {.identify = [&texts, disk](const std::filesystem::path& path) -> Result<std::string> {
            auto identity = disk.identify(path);
            if (identity && std::ranges::find(texts.included, path.string(), &IncludedText::path) ==
                                texts.included.end())
              texts.included.push_back({path.string(), *identity});
            return identity;
          },
          .read = [&texts, disk](const std::filesystem::path& path,
                                 std::size_t most_bytes) -> Result<std::string> {
            auto text = disk.read(path, most_bytes);
            const auto noted =
                std::ranges::find(texts.included, path.string(), &IncludedText::path);
            if (text && noted != texts.included.end()) noted->text = *text;
            return text;
          }};
}

xml::TextFiles among(const SceneTexts& texts) {
  const auto find = [&texts](const std::filesystem::path& path) -> Result<IncludedText> {
    const auto found = std::ranges::find(texts.included, path.string(), &IncludedText::path);
    if (found == texts.included.end())
      return fail(ErrorCode::Unreadable, "is not among the texts that are kept");
    return *found;
  };
  return {.identify = [find](const std::filesystem::path& path) -> Result<std::string> {
            auto found = find(path);
            if (!found) return fail(found.error());
            return std::move(found->identity);
          },
          .read = [find](const std::filesystem::path& path, std::size_t) -> Result<std::string> {
            auto found = find(path);
            if (!found) return fail(found.error());
            return std::move(found->text);
          }};
}

}  // namespace

Result<LoadedScene> load_scene_with_texts(const std::string& file, const std::string& root) {
  auto text = read_file(file, largest_scene_file);
  if (!text) return fail(text.error());
  SceneTexts texts{file, *std::move(text)};
  auto scene =
      xml::parse_scene_of(texts.text, file, folder_of_file(file), root, noting(texts, root));
  if (!scene) return fail(scene.error());
  return LoadedScene{*std::move(scene), std::move(texts)};
}

Result<Scene> parse_scene(const SceneTexts& texts, const std::string& root) {
  return xml::parse_scene_of(texts.text, texts.file, folder_of_file(texts.file), root,
                             among(texts));
}

}  // namespace pliant
