#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pliant::cli {

/// A stretch of a text: from a line and column, counted from 1, up to, but not including, an end.
/// Columns count UTF-16 code units, as editors do.
struct ProblemPlace {
  int line = 0;
  int column = 0;
  int end_line = 0;
  int end_column = 0;
};

/// Finds what a message about a line of an XML file is about: an attribute's value or name, or an
/// element's name, whichever stands in that line and is named by the message; otherwise the line
/// without the blanks around it. Each file is read once.
class ProblemPlaces {
 public:
  /// Files other than the `scenes` are read in the folder `root` or below; empty: anywhere.
  ProblemPlaces(std::vector<std::string> scenes, std::string root);
  ~ProblemPlaces();

  /// Null: the file cannot be read, is no XML, or has no such line.
  std::optional<ProblemPlace> find(const std::string& file, int line, std::string_view message);

 private:
  struct Text;

  std::vector<std::string> scenes_;
  std::string root_;
  std::map<std::string, std::unique_ptr<Text>> texts_;
};

}  // namespace pliant::cli
