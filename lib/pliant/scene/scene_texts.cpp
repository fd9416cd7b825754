#include "pliant/scene/scene_texts.hpp"

#include <cstddef>
#include <filesystem>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/core/text.hpp"
#include "pliant/scene/elements/scene_file.hpp"
#include "pliant/scene/text/source_map.hpp"

namespace pliant {
namespace {

using Texts = std::map<std::string_view, std::string_view>;  // by their paths

// The files of `texts`, which must outlive it; a path is all that tells one from another.
xml::TextFiles among(const Texts& texts) {
  const auto find = [&](const std::filesystem::path& path) -> Result<std::string_view> {
    const auto found = texts.find(path.native());
    if (found == texts.end())
      return fail(ErrorCode::Unreadable, "is not among the texts that are kept");
    return found->second;
  };
  return {.identify = [find](const std::filesystem::path& path) -> Result<std::string> {
            if (auto found = find(path); !found) return fail(found.error());
            return path.string();
          },
          .read = [find](const std::filesystem::path& path, std::size_t) -> Result<std::string> {
            const auto found = find(path);
            if (!found) return fail(found.error());
            return std::string(*found);
          }};
}

}  // namespace

SceneTexts texts_of(const Scene& scene) {
  PLIANT_EXPECTS(scene.origin.sources);
  SceneTexts texts;
  std::set<std::string_view> seen;
  for (const SourceMap::Source& source : scene.origin.sources->sources()) {
    const std::string_view text = source.text->text();
    if (!source.include.is_known()) {
      texts.file = source.file;
      texts.text = text;
    } else if (seen.insert(source.file).second) {
      texts.included.push_back({source.file, std::string(text)});
    }
  }
  return texts;
}

Result<Scene> parse_scene(const SceneTexts& texts, const std::string& root,
                          const StopRequest& should_stop) {
  Texts included;
  for (const IncludedText& one : texts.included) included.emplace(one.path, one.text);
  return xml::parse_scene_of(texts.text, texts.file, folder_of_file(texts.file), root,
                             among(included), should_stop);
}

}  // namespace pliant
