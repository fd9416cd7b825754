#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pliant/core/result.hpp"

namespace pliant::editor {

/// The text of a document that is not saved yet, as its journal keeps it.
struct JournalEntry {
  std::string text;
  std::string time;  ///< of its last change, as ISO 8601 has it
};

/// The file in which a command keeps the text of a document until it is saved, so that it outlives
/// the command and the machine. It belongs to this user alone, and no other command writes it.
class Journal {
 public:
  /// A journal of a document in a folder for all of them, which is made if it is not there. What
  /// other commands left there is `left`, unless they still run. Errors: Unwritable.
  static Result<Journal> open(const std::string& folder, const std::string& document);

  /// `$XDG_STATE_HOME/pliant/edit`, else `~/.local/state/pliant/edit`; empty: neither is known.
  static std::string standard_folder();

  /// The newest text that a command did not save before it ended; null: there is none, or all were
  /// taken.
  const JournalEntry* left() const { return left_.empty() ? nullptr : &left_.back().entry; }
  /// Its file goes.
  void take_left();
  /// The same for all that have this text.
  void take_left(const std::string& text);
  /// Its file stays, for the next command.
  void forget_left() { left_.pop_back(); }

  /// Keeps the text. Errors: Unwritable.
  Result<void> write(const std::string& text);
  /// Keeps it no more.
  void clear();

 private:
  struct Left {
    std::string file;
    std::filesystem::file_time_type time;
    JournalEntry entry;
  };

  Journal(std::string stem, std::string document)
      : stem_(std::move(stem)), document_(std::move(document)) {}
  void find_left();
  std::optional<JournalEntry> read(const std::filesystem::path& file) const;

  std::string stem_;  // what the names of all journals of the document begin with
  std::string document_;
  std::string file_;        // ours; empty: there is none
  std::vector<Left> left_;  // the newest last
};

}  // namespace pliant::editor
