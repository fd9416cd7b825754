#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/scene/text/text_place.hpp"

namespace pliant {

/// A text in which places are found by line and column. Requires: less than 4 GiB.
class SourceText {
 public:
  explicit SourceText(std::string text) : own_(std::move(text)), text_(own_) {}
  /// A text that outlives it.
  static std::shared_ptr<const SourceText> of(std::string_view text) {
    return std::shared_ptr<const SourceText>(new SourceText(text, 0));
  }

  SourceText(const SourceText&) = delete;
  SourceText& operator=(const SourceText&) = delete;

  std::string_view text() const { return text_; }

  /// Columns of the first line are counted behind a byte order mark.
  TextSpan span_of(const TextRange& range) const;
  int line_at(std::size_t at) const;

 private:
  static constexpr std::size_t block_size = 4096;  // bytes

  SourceText(std::string_view text, int) : text_(text) {}

  void count() const;
  std::pair<int, int> position_of(std::size_t at) const;  // line and column
  std::size_t units_before(std::size_t at) const;         // UTF-16 units

  std::string own_;
  std::string_view text_;
  // Counted when they are needed first.
  mutable std::once_flag counted_;
  mutable std::vector<std::uint32_t> line_starts_;
  mutable std::vector<std::uint32_t> units_before_blocks_;
};

/// The texts that a scene is read from: that of its file, and that of a file for each <include>;
/// and which of their values were made of definitions.
class SourceMap {
 public:
  struct Source {
    std::string file;
    std::shared_ptr<const SourceText> text = {};  ///< null: it could not be read
    TextPlace include = {};  ///< the <include>; unknown: it is the scene's own file
  };

  /// Definitions and values beyond these are not kept: messages do not tell of them.
  static constexpr std::size_t most_kept = 100'000;

  explicit SourceMap(std::string file, std::shared_ptr<const SourceText> text = {})
      : sources_{{std::move(file), std::move(text)}} {}

  /// The scene's own file has another name from now on.
  void rename(std::string file) { sources_.front().file = std::move(file); }

  /// Returns the index of the text.
  int add(std::string file, TextPlace include);
  void set_text(int text, std::shared_ptr<const SourceText> of) { at(text).text = std::move(of); }

  /// Returns the index of the definition.
  std::uint32_t add_definition(std::string name, TextPlace place);
  /// A value was made of these definitions.
  void add_value(TextPlace value, std::vector<std::uint32_t> definitions);

  const std::vector<Source>& sources() const { return sources_; }  ///< the first is the scene's own
  std::string_view text(int text) const { return sources_[index(text)].text->text(); }

  ScenePlace place_of(const TextPlace& place) const;
  /// The error at a place: the message also tells where the definitions are that the value there
  /// was made of, and how the file was included.
  Error located(Error error, const TextPlace& place) const;

  /// `line 5`, for a message at the place `from`; in different texts `line 5 of rig.xml, included
  /// by shot.xml:9`.
  std::string title_of(const TextPlace& place, const TextPlace& from) const;

  /// `; $w is defined at line 3` for each of these definitions, of which the first are told.
  std::string told(std::span<const std::uint32_t> definitions, const TextPlace& from) const;

  /// Whether a place comes before another one, where each included text stands at its <include>.
  bool is_before(const TextPlace& a, const TextPlace& b) const;

 private:
  struct Definition {
    std::string name;
    TextPlace place;
  };

  static std::size_t index(int text) { return static_cast<std::size_t>(text); }
  Source& at(int text) { return sources_[index(text)]; }
  std::vector<std::uint32_t> way_to(TextPlace place) const;

  std::vector<Source> sources_;
  std::vector<Definition> definitions_;
  // Of values, by their text and the place where they begin.
  std::map<std::pair<int, std::uint32_t>, std::vector<std::uint32_t>> values_;
};

}  // namespace pliant
