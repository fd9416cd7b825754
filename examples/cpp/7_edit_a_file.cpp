// Operations on a scene file: what they do not touch stays as its author wrote it.
// usage: 7_edit_a_file SCENE OUT

#include <cstdio>

#include <pliant/pliant.hpp>

namespace {

int tell(const pliant::Error& error) {
  for (const std::string& line : pliant::to_lines(error))
    std::fprintf(stderr, "%s\n", line.c_str());
  return 2;
}

}  // namespace

int main(int count, char* arguments[]) {
  if (count != 3) return 2;
  namespace edit = pliant::edit;

  // What the simulation would refuse, the document refuses too.
  pliant::DocumentOptions options;
  options.check = [](const pliant::Scene& scene) -> pliant::Result<void> {
    if (auto checked = pliant::Simulation::check(scene); !checked)
      return pliant::fail(checked.error());
    return {};
  };
  auto document = pliant::SceneDocument::open(arguments[1], options);
  if (!document) return tell(document.error());
  const std::string before = document->text();

  // Several operations are one step, all or nothing.
  const auto step = document->apply(
      {edit::Add{"radial", "swell", {{"center", "1 0 1"}}}, edit::SetKey{"swell.magnitude", 1, "0"},
       edit::SetKey{"swell.magnitude", 12, edit::to_text(900)}},
      "add a swell");
  if (!step) return tell(step.error());
  std::printf("%s: %zu edits\n", step->name.c_str(), step->edits.size());

  // A drag is one step: each value takes the place of the one before. Escape takes it back.
  auto drag = document->apply({edit::Set{"swell.forceRadius", "0.5"}}, "drag");
  for (const double radius : {0.6, 0.7})
    if (drag) drag = document->amend({edit::Set{"swell.forceRadius", edit::to_text(radius)}});
  if (drag) drag = document->drop();
  if (!drag) return tell(drag.error());

  // A refusal is the error of a file that has the problem. Nothing has changed.
  const auto refused = document->apply({edit::Set{"swell.forceRadius", "-1"}});
  if (refused) return 1;
  std::printf("refused: %s\n", refused.error().message.c_str());

  if (auto undone = document->undo(); !undone) return tell(undone.error());
  if (document->text() != before) return 1;
  if (auto redone = document->redo(); !redone) return tell(redone.error());
  if (auto saved = document->save_as(arguments[2]); !saved) return tell(saved.error());
  std::printf("saved %s\n", document->file().c_str());
}
