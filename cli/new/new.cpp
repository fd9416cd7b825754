#include "cli/new/new.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/commands/inputs.hpp"
#include "cli/commands/materials.hpp"
#include "cli/new/own_mesh.hpp"
#include "cli/new/starters.hpp"
#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/output_file.hpp"
#include "cli/terminal/progress.hpp"
#include "cli/terminal/report.hpp"
#include "cli/terminal/resources.hpp"
#include "cli/terminal/rounded.hpp"
#include "cli/terminal/shell_word.hpp"
#include "cli/terminal/usage.hpp"
#include "pliant/core/shelf.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/pliant.hpp"
#include "pliant/scene/format/schema.hpp"

namespace pliant::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* schema_name = "pliant-scene.xsd";

// A file that the command writes.
struct NewFile {
  fs::path path;
  std::string text = {};
  bool may_replace = false;  // a file of that name
};

template <class Items>
std::vector<std::string> names_of(const Items& items) {
  std::vector<std::string> names;
  for (const auto& item : items) names.emplace_back(item.name);
  return names;
}

template <class Items>
const auto& find(const Items& items, const std::string& name) {
  return *std::ranges::find_if(items, [&](const auto& item) { return item.name == name; });
}

int list_starters() {
  std::string text = "starters: pliant new NAME -o SCENE\n";
  for (const Starter& starter : starters()) {
    text += fmt::format("  {:<11} {}\n", starter.name, summary_of(starter));
  }
  text += "materials: --material MATERIAL\n";
  for (const Look& look : looks()) text += fmt::format("  {:<11} {}\n", look.name, look.summary);
  print(stdout, text);
  return exit_done;
}

tl::unexpected<Error> refuse(std::string message) {
  return fail(ErrorCode::InvalidInput, std::move(message));
}

// The rules between options, ahead of any work.
Result<void> check(const NewOptions& options, const Starter& starter) {
  if (options.mesh && starter.mesh.empty()) {
    std::string with_mesh;
    for (const Starter& each : starters()) {
      if (each.mesh.empty()) continue;
      with_mesh += (with_mesh.empty() ? "" : ", ") + std::string(each.name);
    }
    return refuse(fmt::format("--mesh: {} makes its own surface; the starters with a mesh are {}",
                              starter.name, with_mesh));
  }
  for (const auto& [name, given] : {std::pair("--object", options.object.has_value()),
                                    std::pair("--root", options.root.has_value())}) {
    if (given && !options.mesh) return refuse(fmt::format("{} needs --mesh", name));
  }
  if (const auto folder = folder_of(options.root); !folder) return fail(folder.error());
  if (options.mesh) {
    if (const auto readable = check_readable(*options.mesh); !readable)
      return refuse(
          fmt::format("--mesh {}: {}", printable(*options.mesh), readable.error().message));
  }
  if (!starter.mesh.empty() && !options.mesh && !options.out) {
    return refuse(
        fmt::format("{} needs -o SCENE, because its mesh is written beside the scene, or "
                    "--mesh with a mesh of your own",
                    starter.name));
  }
  if (options.has_schema && !options.out)
    return refuse("--schema needs -o SCENE: it is written beside the scene");
  return {};
}

// Whether the scene itself may be written.
Result<void> check_out(const NewOptions& options) {
  if (!options.out) return {};
  if (auto there = check_output_file("-o", *options.out); !there) return there;
  if (fs::path(*options.out).extension() == ".xml") return {};
  return refuse(
      fmt::format("-o {}: the name of a scene must end in .xml", printable(*options.out)));
}

// An error of the starter's text with a mesh, or of no file, is one of the mesh, on no line that
// anybody sees.
Error about_mesh(Error error, const std::string& starter, const std::string& mesh) {
  if (error.code == ErrorCode::Interrupted || (!error.file.empty() && error.file != starter))
    return error;
  error.file = mesh;
  error.line = 0;
  return error;
}

// Warns of a mesh that most formats would tear.
void warn_of_precision(const SceneDocument& document, const std::string& mesh,
                       const StarterSource& source, WorkLine& line) {
  const auto piece = measure(document.text(), source);
  const auto loss = piece ? precision_loss_in(piece->low, piece->high) : std::nullopt;
  if (!loss) return;
  line.erase();
  print(stderr, fmt::format("{}: warning: {}\n", printable(mesh),
                            precision_text("it", ".glb, .usda and others", *loss, {0, 0, 0})));
}

// The text of the scene, fitted to the mesh and the material.
Result<std::string> scene_text(const NewOptions& options, const Starter& starter,
                               const fs::path& out) {
  const std::string root = options.root.value_or("");
  auto document = SceneDocument::from_text(std::string(starter.scene), std::string(starter.name),
                                           out.parent_path().string(),
                                           {.root = root, .should_stop = &was_interrupted});
  if (!document) return fail(document.error());
  StarterSource source{.name = std::string(starter.name),
                       .folder = out.parent_path().string(),
                       .root = root,
                       .obj = starter.mesh,
                       .options = simulation_options({})};
  Shelf shelf(part_for_shelf(source.options));
  source.options.shelf = &shelf;
  WorkLine line(options.is_quiet);
  source.options.progressed = line.report();
  if (options.mesh || options.material) {
    auto facts = look_and_play(document->text(), source);
    if (!facts) return fail(facts.error());
    if (options.mesh) {
      const auto piece = measure(document->text(), source);
      if (!piece) return fail(piece.error());
      source.obj = {};
      source.name = "the starter with --mesh";
      const std::string name = path_from(out.parent_path(), *options.mesh);
      facts = use_own_mesh(*document, {name, options.object.value_or("")}, *facts, *piece, source);
      if (!facts) return fail(about_mesh(facts.error(), source.name, *options.mesh));
      warn_of_precision(*document, *options.mesh, source, line);
    }
    if (options.material) {
      auto applied = apply_look(*document, find(looks(), *options.material), *facts, source);
      if (!applied) {
        return fail(options.mesh ? about_mesh(applied.error(), source.name, *options.mesh)
                                 : applied.error());
      }
      if (options.mesh) {
        if (auto held = keep_in_frame(*document, *applied); !held) return fail(held.error());
      }
    }
  }
  if (!starter.mesh.empty() && !options.mesh) {
    const std::string path = document->scene().surfaces.front().name + ".file";
    const auto changed =
        document->apply({edit::Set{path, edit::literal_text(out.stem().string() + ".obj")}});
    if (!changed) return fail(changed.error());
  }
  std::string scene = document->text();
  if (options.has_schema) {
    scene.insert(scene.find('\n') + 1, fmt::format("<?xml-model href=\"{}\"?>\n", schema_name));
  }
  return scene;
}

// Whether a file is there with this content.
bool is_there(const NewFile& file) {
  const auto text = read_file(file.path);
  return text && *text == file.text;
}

tl::unexpected<Error> refuse_existing(const NewFile& file) {
  return refuse(
      fmt::format("{}: the file exists; --force replaces it", printable(file.path.string())));
}

// Whether a file may be written.
Result<void> check_place(const NewFile& file, const NewOptions& options) {
  if (auto place = check_output_file("-o", file.path.string()); !place) return place;
  if (options.mesh && name_one_file(file.path, *options.mesh))
    return refuse_output("-o", file.path, "it is the mesh");
  std::error_code unknown;
  if (file.may_replace || !fs::exists(file.path, unknown)) return {};
  return refuse_existing(file);
}

Result<void> write(const std::vector<NewFile>& files) {
  std::vector<AtomicFile> open;
  for (const NewFile& file : files) {
    auto created = AtomicFile::create(file.path);
    if (!created) return fail(created.error());
    if (auto written = created->write(file.text); !written) return written;
    open.push_back(*std::move(created));
  }
  for (std::size_t k = 0; k < files.size(); ++k) {
    // One that has appeared meanwhile is replaced only if it may be.
    const auto placed =
        files[k].may_replace ? open[k].commit().map([] { return true; }) : open[k].commit_new();
    if (!placed) return fail(placed.error());
    if (!*placed) return refuse_existing(files[k]);
  }
  return {};
}

// The files to write, the scene last: whoever sees it finds the others. `writes_scene`: the scene
// too, not only its text is wanted.
Result<std::vector<NewFile>> files_of(const NewOptions& options, const Starter& starter,
                                      bool writes_scene) {
  const fs::path out = options.out.value_or("");
  std::vector<NewFile> files;
  if (!starter.mesh.empty() && !options.mesh) {
    files.push_back({fs::path(out).replace_extension(".obj"), std::string(starter.mesh)});
  }
  if (options.has_schema) files.push_back({out.parent_path() / schema_name, scene_schema()});
  files.push_back({out});
  if (options.out) {
    for (NewFile& file : files) {
      if (!writes_scene && file.path == out) continue;
      file.may_replace =
          options.is_forced || (file.path.filename() == schema_name && is_there(file));
      if (auto free = check_place(file, options); !free) return fail(free.error());
    }
  }
  auto text = scene_text(options, starter, out);
  if (!text) return fail(text.error());
  files.back().text = *std::move(text);
  return files;
}

}  // namespace

void add_new(CLI::App& app, NewOptions& options) {
  CLI::App* create = app.add_subcommand("new", "Write a commented scene to begin with");
  create->add_option("NAME", options.name, "The starter; lists all by default")
      ->check(one_of(names_of(starters())));
  create->add_option("-o,--out", options.out,
                     "The scene to write, .xml; to the standard output by default");
  create
      ->add_option("--material", options.material,
                   "A material by its look, fitted to the starter's size")
      ->check(one_of(names_of(looks())));
  create->add_option("--mesh", options.mesh,
                     "A mesh of your own for starters that have one, fitted to its size");
  create->add_option("--object", options.object,
                     "The object of that mesh if it has several; pliant info FILE lists them");
  add_root(*create, options.root);
  create->add_flag("--schema", options.has_schema,
                   "Also write pliant-scene.xsd beside the scene, so that editors complete it");
  create->add_flag("--force", options.is_forced, "Replace files that exist");
  create->add_flag("--quiet", options.is_quiet, "No progress");
}

Result<NewScene> new_scene(const NewOptions& options) {
  const auto known = names_of(starters());
  if (std::ranges::find(known, options.name.value_or("")) == known.end())
    return refuse(fmt::format("no starter is named {}", printable(options.name.value_or(""))));
  const auto materials = names_of(looks());
  if (options.material && std::ranges::find(materials, *options.material) == materials.end())
    return refuse(fmt::format("no material is named {}", printable(*options.material)));
  const Starter& starter = find(starters(), *options.name);
  if (auto allowed = check(options, starter); !allowed) return fail(allowed.error());
  auto files = files_of(options, starter, false);
  if (!files) return fail(files.error());
  NewScene scene{std::move(files->back().text)};
  files->pop_back();
  for (NewFile& file : *files) scene.files.emplace_back(file.path.string(), std::move(file.text));
  return scene;
}

int run_new(const NewOptions& options) {
  if (!options.name) {
    if (options.out || options.material || options.mesh || options.object || options.root ||
        options.has_schema) {
      return report(
          {ErrorCode::InvalidInput, "new needs the NAME of a starter with these options"});
    }
    return list_starters();
  }
  catch_interrupts();
  const Starter& starter = find(starters(), *options.name);
  if (auto allowed = check(options, starter); !allowed) return report(allowed.error());
  if (auto allowed = check_out(options); !allowed) return report(allowed.error());
  const auto files = files_of(options, starter, true);
  if (!files) return report(files.error());
  if (!options.out) {
    print(stdout, files->back().text);
    return exit_done;
  }
  if (auto written = write(*files); !written) return report(written.error());
  std::string names;
  for (const NewFile& file : *files)
    names += (names.empty() ? "" : ", ") + printable(file.path.string());
  print(stdout, fmt::format("{}: written; next: pliant view {} --serve\n", names,
                            shell_word(*options.out)));
  return exit_done;
}

}  // namespace pliant::cli
