#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/document/draft.hpp"
#include "pliant/document/editor.hpp"

namespace pliant::edit {

/// Makes operations that concern a single object each in a draft of the object alone: many of them
/// cost as much as their objects, not each as much as the whole text.
class ObjectDrafts {
 public:
  /// Of a draft of a whole scene. `scene`: see `Editor`. Both must outlive it.
  ObjectDrafts(Draft& whole, const Scene& scene) : whole_(whole), scene_(scene) {}

  /// Makes an operation, or returns false: it must be made in the whole draft, after `flush`, and
  /// may be refused there.
  bool apply(const Operation& operation);

  /// Makes all changes in the whole draft. Errors: those of `Draft::commit`.
  Result<void> flush();

  /// As `Editor::parts`.
  const std::set<std::string>& parts() const { return parts_; }

 private:
  struct ObjectText {
    std::string text;                // of a scene with this object only
    std::size_t begin = 0;           // of the object in it
    std::vector<EditBatch> batches;  // one after the other
  };

  ObjectText* text_of(std::string_view name);
  std::string scene_around(ElementIndex object, std::size_t& begin) const;
  void find_objects();

  Draft& whole_;
  const Scene& scene_;
  std::map<std::string, ElementIndex> objects_;  // of the whole draft, by name; empty: not known
  std::string indent_;                           // of the whole draft
  std::map<std::string, ObjectText, std::less<>> parts_of_text_;  // by the name of the object
  std::set<std::string> parts_;
};

}  // namespace pliant::edit
