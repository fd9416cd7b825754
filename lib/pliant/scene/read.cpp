#include "pliant/scene/read.hpp"

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <tinyxml2.h>

#include "pliant/core/open_file.hpp"
#include "pliant/core/read_file.hpp"
#include "pliant/scene/channel_check.hpp"
#include "pliant/scene/channels.hpp"
#include "pliant/scene/check.hpp"
#include "pliant/scene/expand.hpp"
#include "pliant/scene/markup.hpp"
#include "pliant/scene/nearest.hpp"
#include "pliant/scene/read_elements.hpp"
#include "pliant/scene/rules.hpp"

namespace pliant {

using namespace xml;

namespace {

/// Appends all children that have a valid name, whatever their other problems, and those of groups.
void add_named_children(const tinyxml2::XMLElement& parent, std::vector<Named>& named) {
  for (const auto* child = parent.FirstChildElement(); child; child = child->NextSiblingElement()) {
    if (const auto* name = child->FindAttribute("name"); name && is_name(name->Value()))
      named.push_back({child->Name(), name->Value(), name->GetLineNum()});
    const bool is_in_scene = parent.Parent() == parent.GetDocument();
    if (is_in_scene && child->Name() == std::string_view("group"))
      add_named_children(*child, named);
  }
}

/// `NAME.attribute` of the channels that are animated.
std::set<std::string> animated_channels(const Scene& scene) {
  std::set<std::string> paths;
  for (const NamedChannel& named : channels_of(scene))
    if (named.is_animated()) paths.insert(named.path);
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
    const std::set<std::string> animated = animated_channels(scene);
    const auto is_constant = [&](const std::string& name, std::string_view attribute) {
      const auto is_animated = [&](std::string_view of) {
        return animated.contains(fmt::format("{}.{}", name, of));
      };
      if (attribute == "c") return !is_animated("b") && !is_animated("c") && !is_animated("d");
      return !is_animated(attribute);
    };
    const auto is_checked = [&](const std::string& name, std::string_view attribute) {
      return is_sound(name, attribute) && (attribute != "dt" || is_sound("", "fps")) &&
             (is_all || is_constant(name, attribute));
    };
    for (Error& error : check_channels(scene, is_checked))
      file.findings.add_problem(error.line, std::move(error.message));
  }
  if (file.findings.problem_count() == 0) return;
  for (const NamedMesh& mesh : file.meshes)
    if (const auto readable = OpenFile::open(mesh.path, file.root); !readable)
      file.findings.add_problem(
          mesh.line,
          unreadable_mesh(readable.error(), mesh.surface, scene.origin, mesh.attribute).message);
}

Scene read_root(const tinyxml2::XMLElement& root, SceneFile& file) {
  Scene scene;
  Table table = table_of(scene);
  read_attributes(root, table, file.findings);
  file.lines[""] = root.GetLineNum();
  record("", table, file);

  using Element = tinyxml2::XMLElement;
  std::vector<Child> children = {
      {"surface",
       [&](const Element& child) { scene.surfaces.push_back(read_surface(child, file)); }},
  };
  for (const Force& kind : force_kinds())
    children.push_back({kind_of(kind), [&, kind](const Element& child) {
                          scene.forces.push_back(read_force(child, kind, nullptr, file));
                        }});
  children.push_back({"group", [&](const Element& child) {
                        scene.groups.push_back(read_group(child, scene.forces, file));
                      }});
  read_children(root, children, file.findings);

  std::vector<Named> named;
  add_named_children(root, named);
  for (const auto& [part, line] : file.lines) scene.origin.lines.push_back({part, line});
  if (file.is_expanded) check(scene, named, file);
  note_idle_targets(scene, file.findings);
  return scene;
}

/// Scans the text, and expands it into `expanded` if it needs that; `text` is then the expanded
/// one. Returns whether it can be read, perhaps only to find further problems.
bool prepare(std::string_view& text, std::string& expanded, const std::string& name,
             SceneFile& file) {
  const std::optional<Markup> markup = scan_markup(text, file.findings);
  if (!markup) return false;
  const SourceText source{text, *markup, name, file.folder};
  if (!needs_expansion(source)) return true;
  std::optional<Expansion> expansion = expand(source, file.texts, file.findings);
  if (!expansion) return false;
  expanded = std::move(expansion->text);
  text = expanded;
  file.findings.use(expansion->files, std::move(expansion->values));
  file.files = std::move(expansion->files);
  file.is_expanded = expansion->is_sound;
  // Each file is well-formed, but all together may be nested too deep, or too large.
  if (!scan_markup(text, file.findings)) return false;
  for (const std::size_t at : expansion->unknown) expanded[at] = unknown_value;
  return true;
}

/// Reads a document whose root is probably a <scene>.
std::optional<Scene> read_document(const tinyxml2::XMLDocument& document, SceneFile& file) {
  const tinyxml2::XMLElement& root = *document.RootElement();
  constexpr std::string_view expected[] = {"scene"};
  if (root.Name() != expected[0]) {
    const bool is_fragment = root.Name() == std::string_view("fragment");
    file.findings.add_problem(
        root.GetLineNum(),
        fmt::format("the root element is {}{}", tag(root),
                    is_fragment ? ", which a <scene> may include, but which is none itself"
                                : hint(root.Name(), expected)));
    return std::nullopt;
  }
  return read_root(root, file);
}

}  // namespace

Result<Scene> load_scene(const std::string& file, const std::string& root) {
  const Result<std::string> text = read_file(file, largest_scene_file);
  if (!text) return fail(text.error());
  return parse_scene(*text, file, std::filesystem::path(file).parent_path(), root);
}

Result<Scene> parse_scene(std::string_view text, const std::string& name, const std::string& folder,
                          const std::string& root) {
  return parse_scene_of(text, name, folder, root, files_on_disk(root));
}

Result<Scene> xml::parse_scene_of(std::string_view text, const std::string& name,
                                  const std::string& folder, const std::string& root,
                                  TextFiles texts) {
  SceneFile file{
      .folder = folder, .root = root, .texts = std::move(texts), .findings = Findings(name)};
  if (text.size() > largest_scene_file)
    return fail(ErrorCode::InvalidInput,
                fmt::format("the scene is larger than {} MiB", largest_scene_file >> 20U), name);
  std::string expanded;
  if (!prepare(text, expanded, name, file)) return fail(file.findings.to_error());

  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    file.findings.add_problem(document.ErrorLineNum(),
                              fmt::format("malformed XML: {}", document.ErrorName()));
    return fail(file.findings.to_error());
  }
  std::optional<Scene> scene = read_document(document, file);
  if (!scene || file.findings.problem_count() != 0) return fail(file.findings.to_error());
  scene->origin.file = name;
  scene->origin.root = root;
  if (file.files && file.files->texts().size() > 1) scene->origin.files = std::move(file.files);
  scene->notes = file.findings.notes();
  return std::move(*scene);
}

}  // namespace pliant
