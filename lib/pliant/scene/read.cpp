#include "pliant/scene/read.hpp"

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/text.hpp"
#include "pliant/files/open_file.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/scene/checks/channel_check.hpp"
#include "pliant/scene/checks/check.hpp"
#include "pliant/scene/checks/rules.hpp"
#include "pliant/scene/elements/read_elements.hpp"
#include "pliant/scene/format/nearest.hpp"
#include "pliant/scene/sharing/expand.hpp"
#include "pliant/scene/text/markup.hpp"
#include "pliant/scene/text/tree.hpp"

namespace pliant {

using namespace xml;

namespace {

// Of the work for each, see StopPoll.
constexpr std::size_t parts_of_object = 1024, parts_of_channel = 256, parts_of_place = 64;

/// Appends all children that have a valid name, whatever their other problems, and those of groups.
void add_named_children(const Element& parent, std::vector<Named>& named, Findings& findings) {
  for (auto child = parent.first_child(); child; child = child->next()) {
    if (findings.is_over(parts_of_object)) return;
    if (const auto name = child->attribute("name"); name && is_name(name->value))
      named.push_back({child->name(), name->value, name->value_place()});
    if (parent.is_root() && child->name() == "group") add_named_children(*child, named, findings);
  }
}

/// `NAME.attribute` of the channels that are animated.
std::set<std::string> animated_channels(const Scene& scene, Findings& findings) {
  std::set<std::string> paths;
  const auto add = [&](const auto& things) {
    for (const auto& thing : things) {
      if (findings.is_over(parts_of_object)) return;
      for_each_channel(thing, [&](const std::string& name, const Attribute&, const auto& channel) {
        if (channel.is_animated()) paths.insert(fmt::format("{}.{}", thing.name, name));
      });
    }
  };
  add(scene.surfaces);
  add(scene.forces);
  add(scene.groups);
  add(scene.colliders);
  return paths;
}

/// Checks sound values. If there is a problem, also what only a run would reject, so that all
/// problems of a file are reported at once: channels that break their rule at a frame, and mesh
/// files that cannot be opened.
void check(const Scene& scene, std::span<const Named> named, SceneFile& file) {
  std::map<std::string_view, int> times;  // times that a name is used
  for (const Named& one : named) ++times[one.name];
  const auto is_sound = [&](const std::string& name, std::string_view attribute) {
    const auto found = times.find(name);
    const bool is_unique = name.empty() || (found != times.end() && found->second == 1);
    return is_unique && !file.unsound.contains(fmt::format("{}.{}", name, attribute));
  };
  check_whole(scene, named, is_sound, file.findings);

  const bool is_all = file.findings.problem_count() != 0;
  if (is_sound("", "start") && is_sound("", "end")) {
    const std::set<std::string> animated = animated_channels(scene, file.findings);
    const auto is_constant = [&](const std::string& name, std::string_view attribute) {
      const auto is_animated = [&](std::string_view of) {
        return animated.contains(fmt::format("{}.{}", name, of));
      };
      if (attribute == "c") return !is_animated("b") && !is_animated("c") && !is_animated("d");
      return !is_animated(attribute);
    };
    const auto is_over = [&] { return file.findings.is_over(parts_of_channel); };
    const auto is_checked = [&](const std::string& name, std::string_view attribute) {
      return is_sound(name, attribute) && (attribute != "dt" || is_sound("", "fps")) &&
             (is_all || is_constant(name, attribute));
    };
    for (Error& error : check_channels(scene, is_checked, is_over))
      file.findings.add_problem(std::move(error));
  }
  if (file.findings.problem_count() == 0) return;
  for (const NamedMesh& mesh : file.meshes) {
    if (file.findings.is_over(parts_of_object)) return;
    if (const auto readable = OpenFile::open(mesh.path, file.root); !readable)
      file.findings.add_problem(
          mesh.place, unreadable_mesh(readable.error(), title_of_object(scene, mesh.owner)));
  }
}

Scene read_root(const Element& root, SceneFile& file) {
  Scene scene;
  Contents contents = contents_of(scene);
  read_contents(root, contents, "", file);
  const auto give_root = [&](const std::string& name, MeshFile& mesh) {
    const auto named = file.parts.find(fmt::format("{}.file", name));
    mesh.root =
        (file.root.empty() ? file.folder_of(named != file.parts.end() ? named->second.text : 0)
                           : file.root)
            .string();
    if (mesh.root.empty()) mesh.root = ".";  // empty would mean the mesh's own folder
  };
  for (Surface& surface : scene.surfaces)
    if (auto* const mesh = std::get_if<MeshFile>(&surface.shape)) give_root(surface.name, *mesh);
  for (Collider& collider : scene.colliders)
    if (auto* const closed = std::get_if<ClosedMesh>(&collider.shape))
      give_root(collider.name, closed->mesh);

  std::vector<Named> named;
  add_named_children(root, named, file.findings);
  scene.origin.sources = file.sources;
  scene.origin.parts.reserve(file.parts.size());
  for (; !file.parts.empty() && !file.findings.is_over(parts_of_place);) {
    auto first = file.parts.extract(file.parts.begin());
    scene.origin.parts.push_back({std::move(first.key()), first.mapped()});
  }
  if (file.is_expanded) check(scene, named, file);
  note_idle_targets(scene, file.findings);
  return scene;
}

/// Reads a root that is probably a <scene>.
std::optional<Scene> read_document(const Element& root, SceneFile& file) {
  // That it stands there is reported.
  if (root.name() == include_name || root.name() == define_name) return std::nullopt;
  constexpr std::string_view expected[] = {"scene"};
  if (root.name() != expected[0]) {
    const bool is_fragment = root.name() == "fragment";
    file.findings.add_problem(
        root.place(),
        is_fragment ? "the root element is <fragment>, which is not a scene, but what a scene "
                      "may include"
        // The text may be of any file, and its words a secret.
        : nearest_word(root.name(), expected)
            ? fmt::format("the root element is {}{}", tag(root), hint(root.name(), expected))
            : std::string("the root element is not <scene>"));
    return std::nullopt;
  }
  return read_root(root, file);
}

Result<void> check_size(std::string_view text, const std::string& name) {
  if (text.size() <= largest_scene_file) return {};
  return fail(ErrorCode::InvalidInput,
              fmt::format("the scene is larger than {} MiB", largest_scene_file >> 20U), name);
}

}  // namespace

Result<Scene> load_scene(const std::string& file, const std::string& root,
                         const StopRequest& should_stop) {
  Result<std::string> text = read_file(file, largest_scene_file, should_stop);
  if (!text) return fail(text.error());
  return parse_scene_of(*std::move(text), file, folder_of_file(file), root,
                        files_on_disk(root, should_stop), should_stop);
}

Result<Scene> parse_scene(std::string_view text, const std::string& name, const std::string& folder,
                          const std::string& root, const StopRequest& should_stop) {
  if (auto fits = check_size(text, name); !fits) return fail(fits.error());
  return parse_scene_of(std::string(text), name, folder, root, files_on_disk(root, should_stop),
                        should_stop);
}

Result<Scene> xml::parse_scene_of(std::string text, const std::string& name,
                                  const std::string& folder, const std::string& root,
                                  TextFiles texts, const StopRequest& should_stop) {
  if (auto fits = check_size(text, name); !fits) return fail(fits.error());
  const auto sources =
      std::make_shared<SourceMap>(name, std::make_shared<SourceText>(std::move(text)));
  SceneFile file{.folder = folder,
                 .root = root,
                 .texts = std::move(texts),
                 .sources = sources,
                 .findings = Findings(sources, should_stop)};
  const std::optional<Markup> markup = scan_markup(file.findings);
  if (!markup) return fail(file.findings.to_error());
  const std::optional<Expansion> expansion =
      expand(*markup, file.folder, file.texts, *sources, file.findings);
  if (!expansion) return fail(file.findings.to_error());
  file.is_expanded = expansion->is_sound;
  std::optional<Scene> scene = read_document(expansion->tree.root(), file);
  if (!scene || file.findings.problem_count() != 0) return fail(file.findings.to_error());
  scene->origin.file = name;
  scene->origin.root = root;
  scene->notes = file.findings.notes();
  return std::move(*scene);
}

}  // namespace pliant
