#pragma once

#include <string>
#include <utility>
#include <vector>

namespace pliant {

/// A place in a file of a scene, for messages.
struct ScenePlace {
  std::string file;  ///< the scene's, as the caller named it, or one that is included
  int line = 0;      ///< counted from 1; 0: unknown
  /// How an included file became part of the scene, from the inside out: `included by rig.xml:4,
  /// by shot.xml:12`. Empty: it is the scene's own file.
  std::string chain = {};

  /// The message, with the chain at its end.
  std::string told(std::string message) const;
};

/// A text that is part of a scene: that of its file, or of a file at one <include>.
struct SceneText {
  static constexpr int none = -1;

  std::string file;
  int parent = none;  ///< index of the text that includes it
  int line = 0;       ///< of the <include>
};

/// Lines of the expanded text that follow each other in one of its texts.
struct LineRun {
  int first = 1;  ///< in the expanded text
  int text = 0;   ///< index
  int line = 1;   ///< in that text
};

/// The places of the lines of an expanded text: the text of a scene's file in which that of the
/// included files takes the place of each <include>. Each of its lines is of one text.
class LineMap {
 public:
  /// Every line is that of the file.
  explicit LineMap(std::string file = {});

  /// The scene's own file has another name from now on.
  void rename(std::string file) { texts_.front().file = std::move(file); }

  /// Adds a text that is included at a line of another one; returns its index.
  int add_text(std::string file, int parent, int line);

  /// From `first` on, which is not before that of the last run, lines are those of a text from
  /// `line` on.
  void add_run(int first, int text, int line);

  /// The index of the text that contains a line; 0: the scene's own file.
  int text_of(int line) const;

  /// The place of a line of the expanded text.
  ScenePlace place_of(int line) const;

  /// The place of a line of a text.
  ScenePlace place_in(int text, int line) const;

  /// `line 5`, for a message at the line `from` of the expanded text; if they are of different
  /// texts, `line 5 of rig.xml, included by shot.xml:9`.
  std::string title_of(int line, int from) const;

  /// The same for a line of a text, in a message at the text `from`.
  std::string title_in(int text, int line, int from) const;

  const std::vector<SceneText>& texts() const { return texts_; }  ///< the first is the scene's own

 private:
  const LineRun& run_of(int line) const;

  std::vector<SceneText> texts_;
  std::vector<LineRun> runs_;
};

}  // namespace pliant
