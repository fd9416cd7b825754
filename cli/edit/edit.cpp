#include "cli/edit/edit.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/commands/inputs.hpp"
#include "cli/commands/materials.hpp"
#include "cli/edit/scene_exporter.hpp"
#include "cli/new/new.hpp"
#include "cli/new/starters.hpp"
#include "cli/terminal/child.hpp"
#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/report.hpp"
#include "cli/terminal/usage.hpp"
#include "editor/edit_server.hpp"
#include "pliant/core/text.hpp"
#include "viewer/edit_page.hpp"

namespace pliant::cli {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using editor::Json;

Json starters_json() {
  Json json = {{"starters", Json::array()}, {"materials", Json::array()}};
  for (const Starter& starter : starters())
    json["starters"].push_back({{"name", starter.name}, {"summary", summary_of(starter)}});
  for (const Look& look : looks())
    json["materials"].push_back({{"name", look.name}, {"summary", look.summary}});
  return json;
}

std::optional<std::string> picture_of(const std::string& name) {
  const auto all = starters();
  const auto found = std::ranges::find(all, name, &Starter::name);
  if (found == all.end() || found->picture.empty()) return {};
  return std::string(found->picture);
}

Result<editor::Beginning> begin_scene(const std::string& starter, const std::string& material,
                                      const std::string& mesh, const std::string& object,
                                      const std::string& file) {
  NewOptions options{.name = starter, .out = file, .is_forced = true, .is_quiet = true};
  if (!material.empty()) options.material = material;
  if (!mesh.empty()) options.mesh = mesh;
  if (!object.empty()) options.object = object;
  auto scene = new_scene(options);
  if (!scene) return fail(scene.error());
  return editor::Beginning{std::move(scene->text), std::move(scene->files)};
}

Result<std::string> with_material(const SceneDocument& document, const std::string& surface,
                                  const std::string& material, const std::string& root,
                                  const ResourceOptions& resources) {
  const auto all = looks();
  const auto look = std::ranges::find(all, material, &Look::name);
  if (look == all.end())
    return fail(ErrorCode::InvalidInput,
                fmt::format("no material is named {}", printable(material)));
  const auto& surfaces = document.scene().surfaces;
  const auto found = std::ranges::find(surfaces, surface, &Surface::name);
  if (found == surfaces.end())
    return fail(ErrorCode::InvalidInput, fmt::format("no surface is named {}", printable(surface)));
  StarterSource source{.name = document.file(),
                       .folder = document.folder(),
                       .root = root,
                       .options = simulation_options(resources)};
  source.surface = static_cast<std::size_t>(found - surfaces.begin());
  const auto facts = look_and_play(document.text(), source);
  if (!facts) return fail(facts.error());
  SceneDocument changed = document;
  if (auto applied = apply_look(changed, *look, *facts, source); !applied)
    return fail(applied.error());
  return changed.text();
}

// The folder of everything, and the scene's file in it as typed.
Result<editor::SessionOptions> session_options(const EditOptions& options) {
  if (options.scene) {
    if (auto file = check_scene_is_file(*options.scene, "pliant edit writes it"); !file)
      return fail(file.error());
  }
  const auto given = folder_of(options.root);
  if (!given) return fail(given.error());
  std::error_code unknown;
  const fs::path scene = options.scene ? fs::absolute(*options.scene) : fs::path();
  const fs::path folder = scene.empty() ? fs::current_path() : scene.parent_path();
  if (!fs::is_directory(folder, unknown))
    return fail(ErrorCode::InvalidInput,
                fmt::format("{}: there is no folder for it", printable(*options.scene)));
  editor::SessionOptions session;
  session.root = fs::canonical(given->empty() ? folder : fs::absolute(*given)).string();
  if (!scene.empty()) {
    session.file = *options.scene;
    if (fs::exists(session.file, unknown) && !fs::is_regular_file(session.file, unknown))
      return fail(ErrorCode::Unreadable, "it is a folder or a device, not a file", *options.scene);
    if (ending_of(session.file) != ".xml" && !fs::exists(session.file, unknown))
      return fail(ErrorCode::InvalidInput, fmt::format("{}: the name of a scene must end in .xml",
                                                       printable(*options.scene)));
    const fs::path place = fs::weakly_canonical(scene, unknown);
    if (unknown)
      return fail(ErrorCode::Unreadable, "cannot read the file: " + unknown.message(),
                  *options.scene);
    const fs::path inside = place.lexically_relative(session.root);
    if (inside.empty() || *inside.begin() == "..")
      return fail(ErrorCode::InvalidInput,
                  fmt::format("{} is not in the folder {}; --root names one that contains it",
                              printable(*options.scene), printable(session.root)));
  }
  session.simulation = simulation_options(options.resources);
  session.tools.starters = &starters_json;
  session.tools.picture = &picture_of;
  session.tools.begin = &begin_scene;
  session.tools.material = [root = session.root, resources = options.resources](
                               const SceneDocument& document, const std::string& surface,
                               const std::string& material) {
    return with_material(document, surface, material, root, resources);
  };
  return session;
}

void open_browser(const std::string& address) {
  if (!is_on_path("xdg-open")) return;
  const auto child = start_child({"xdg-open", address}, {});
  if (!child) return;  // the address was printed
  std::thread([id = *child] { await_child(id); }).detach();
}

}  // namespace

void add_edit(CLI::App& app, EditOptions& options) {
  CLI::App* edit = app.add_subcommand("edit", "Edit a scene in the browser while it plays");
  edit->add_option(
      "SCENE", options.scene,
      "Scene file; one that is not there yet, or none, begins with a choice of scenes");
  edit->add_option("--port", options.port, "Port of the page; any free one by default")
      ->check(integer_from(0, 65535));
  edit->add_option("--root", options.root,
                   "Folder of all files that are read or written; that of SCENE by default");
  edit->add_flag("--no-open", options.opens_no_browser, "Only print the address");
  add_threads(*edit, options.resources);
  add_memory(*edit, options.resources);
  edit->add_flag("--quiet", options.is_quiet, "Print nothing but the address");
}

int run_edit(const EditOptions& options) {
  catch_interrupts();
  auto session = session_options(options);
  if (!session) return report(session.error());
  const auto page = viewer::edit_page_template();
  if (!page) return report(page.error());
  auto server = editor::EditServer::start(std::string(*page), options.port, *std::move(session),
                                          make_exporter(options.resources));
  if (!server) return report(server.error());
  print(stdout, server->address() + '\n');
  if (std::ferror(stdout) != 0) return exit_failed;  // nobody learns the address
  if (!options.is_quiet) print_notes(server->notes());
  if (!options.opens_no_browser) open_browser(server->address());
  while (!was_interrupted()) std::this_thread::sleep_for(50ms);
  const auto unsaved = server->finish();
  return unsaved ? report(*unsaved) : exit_done;
}

}  // namespace pliant::cli
