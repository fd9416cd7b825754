#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/scene/text/findings.hpp"
#include "pliant/scene/text/markup.hpp"
#include "pliant/scene/text/source_map.hpp"
#include "pliant/scene/text/tree.hpp"

namespace pliant::xml {

/// The most files that include each other, one in the other.
inline constexpr int deepest_include = 16;
/// The most files that a scene includes, each counted as often as it is included.
inline constexpr int most_includes = 10'000;
/// The most definitions, each counted as often as its file is included.
inline constexpr int most_definitions = 1'000'000;
/// The most bytes of all texts of a scene, each counted as often as it is included, together with
/// the values of all definitions and all values that are made of them.
inline constexpr std::size_t most_expanded = std::size_t{256} << 20U;
/// The most bytes of a value in which a definition is used.
inline constexpr std::size_t longest_value = std::size_t{64} << 10U;

/// The files that a text may include.
struct TextFiles {
  /// What tells a file from all others: paths to one file have the same. Errors: it may not be
  /// read.
  std::function<Result<std::string>(const std::filesystem::path&)> identify;
  /// The bytes of a file. Errors: it cannot be read, or has more than so many bytes.
  std::function<Result<std::string>(const std::filesystem::path&, std::size_t most_bytes)> read;
};

/// Regular files on the disk, in the folder `root` or below; empty: anywhere. What is read is the
/// file that was identified, if that was the last one.
TextFiles files_on_disk(const std::filesystem::path& root, const StopRequest& should_stop = {});

/// A file that is included, read once.
struct IncludedFile {
  std::shared_ptr<const SourceText> text = {};
  std::optional<Markup> markup = {};  ///< null: it has problems, which are reported
};

/// The elements of a scene, and the included files that they are of.
struct Expansion {
  Tree tree;
  std::map<std::string, std::unique_ptr<IncludedFile>> files = {};  ///< by identity
  bool is_sound = true;  ///< false: some content is missing, for reasons that are reported
};

/// Expands the text of a scene, the first of the sources: docs/scene-format.md, "Sharing". Adds the
/// texts of the included files and the values that definitions made to the sources. All problems of
/// including and defining are found; to find those of the rest, an <include> stays where a file
/// could not be included. Null after a problem that concerns a limit. The sources and the markup
/// must outlive the expansion. `folder`: that of the scene's file.
std::optional<Expansion> expand(const Markup& markup, const std::filesystem::path& folder,
                                const TextFiles& files, SourceMap& sources, Findings& findings);

}  // namespace pliant::xml
