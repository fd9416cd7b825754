#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/scene/format/description.hpp"
#include "pliant/scene/text/defined_values.hpp"
#include "pliant/scene/text/findings.hpp"
#include "pliant/scene/text/line_map.hpp"
#include "pliant/scene/text/markup.hpp"

namespace pliant {
namespace xml {

/// The most files that include each other, one in the other.
inline constexpr int deepest_include = 16;
/// The most files that a scene includes, each counted as often as it is included.
inline constexpr int most_includes = 10'000;
/// The most definitions, each counted as often as its file is included.
inline constexpr int most_definitions = 1'000'000;
/// The most bytes of an expanded text; also of all that is read for it, each file counted as often
/// as it is included, together with the values of all definitions.
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

/// A text of a file before it is expanded.
struct SourceText {
  std::string_view text;
  const Markup& markup;
  std::string name;              ///< of the file, in messages
  std::filesystem::path folder;  ///< paths in it are relative to this
};

/// Whether a text has an <include>, a <define> or a `$`; otherwise it is its own expansion.
bool needs_expansion(const SourceText& source, Findings& findings);

/// A text in which the content of files has taken the place of each <include>, the value of
/// definitions that of each `$NAME`, and in which no <define> is left.
struct Expansion {
  std::string text;
  LineMap files;                          ///< of its lines
  DefinedValues values = {};              ///< those that were made of definitions
  bool is_sound = true;                   ///< false: there are problems, see below
  std::vector<std::size_t> unknown = {};  ///< offsets of the values that could not be made
};

/// What takes the place of a value that could not be made, once the expanded text is scanned: a
/// character that no file may have. Its problem is reported.
inline constexpr char unknown_value = '\x01';

/// Expands the text of a scene: docs/scene-format.md, "Sharing". Each element and attribute of the
/// result begins on the line of the expansion whose place in `files` is that of the element or
/// attribute in its file. All problems of including and defining are found. For those of the rest,
/// an <include/> then stands where a file could not be included, and a `?` for a value that could
/// not be made. Null after a problem that concerns a limit.
std::optional<Expansion> expand(const SourceText& scene, const TextFiles& files,
                                Findings& findings);

/// The elements that an <include> or a <define> may stand in.
std::vector<std::string_view> including_elements();

/// The attributes of an <include>.
struct IncludeText {
  std::string file = {};
};

/// The attributes of a <define>.
struct DefineText {
  std::string name = {};
  std::string value = {};
};

}  // namespace xml

template <>
struct Description<xml::IncludeText> {
  static constexpr std::string_view element = "include";
  static constexpr std::string_view meaning =
      "A file whose content takes the place of this element.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "file",
                  .meaning = "the file whose content takes the place of the element",
                  .need = Need::Required,
                  .syntax = Syntax::Path},
        of.file...);
  }
};

template <>
struct Description<xml::DefineText> {
  static constexpr std::string_view element = "define";
  static constexpr std::string_view meaning =
      "A name for a text, which $name stands for from here on.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "name",
                  .meaning = "the name: a letter or _, then letters, digits and _",
                  .need = Need::Required},
        of.name...);
    row(Attribute{.name = "value",
                  .meaning = "what `$name` stands for from here on",
                  .need = Need::Required},
        of.value...);
  }
};

}  // namespace pliant
