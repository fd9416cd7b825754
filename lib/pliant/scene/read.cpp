#include "pliant/scene/read.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <tinyxml2.h>

#include "pliant/core/read_file.hpp"
#include "pliant/scene/check.hpp"
#include "pliant/scene/force.hpp"
#include "pliant/scene/group.hpp"
#include "pliant/scene/markup.hpp"
#include "pliant/scene/nearest.hpp"
#include "pliant/scene/rules.hpp"
#include "pliant/scene/surface.hpp"

namespace pliant {

using namespace xml;

namespace {

constexpr std::size_t largest_file = std::size_t{256} << 20U;  // bytes

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

Scene read_root(const tinyxml2::XMLElement& root, SceneFile& file) {
  Scene scene;
  Table table = table_of(scene);
  read_attributes(root, table, file.findings);
  check_frames(scene, table, file.findings);
  file.lines[""] = root.GetLineNum();
  record("", table, file);

  const std::optional<double> fps =
      find(table, "fps")->is_sound ? std::optional<double>(scene.fps) : std::nullopt;
  using Element = tinyxml2::XMLElement;
  std::vector<Child> children = {
      {"surface",
       [&](const Element& child) { scene.surfaces.push_back(read_surface(child, fps, file)); }},
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
  check_unique(named, file.findings);
  check_targets(scene, file.targets, named, file.findings);
  for (const auto& [part, line] : file.lines) scene.origin.lines.push_back({part, line});
  note_idle_targets(scene, file.findings);
  if (file.findings.problem_count() != 0) check_further(scene, named, file);
  return scene;
}

/// Reads a document whose root is probably a <scene>.
std::optional<Scene> read_document(const tinyxml2::XMLDocument& document, SceneFile& file) {
  const tinyxml2::XMLElement& root = *document.RootElement();
  constexpr std::string_view expected[] = {"scene"};
  if (root.Name() != expected[0]) {
    file.findings.add_problem(root.GetLineNum(), fmt::format("the root element is {}{}", tag(root),
                                                             hint(root.Name(), expected)));
    return std::nullopt;
  }
  return read_root(root, file);
}

}  // namespace

Result<Scene> load_scene(const std::string& file, const std::string& root) {
  const Result<std::string> text = read_file(file, largest_file);
  if (!text) return fail(text.error());
  return parse_scene(*text, file, std::filesystem::path(file).parent_path(), root);
}

Result<Scene> parse_scene(std::string_view text, const std::string& name, const std::string& folder,
                          const std::string& root) {
  // An empty root would mean each mesh's own folder.
  const std::string own = folder.empty() ? "." : folder;
  SceneFile file{.folder = folder, .root = root.empty() ? own : root, .findings = Findings(name)};
  if (text.size() > largest_file)
    return fail(ErrorCode::InvalidInput,
                fmt::format("the scene is larger than {} MiB", largest_file >> 20U), name);
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // the byte order mark
  if (!check_markup(text, file.findings)) return fail(file.findings.to_error());

  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    file.findings.add_problem(document.ErrorLineNum(),
                              fmt::format("malformed XML: {}", document.ErrorName()));
    return fail(file.findings.to_error());
  }
  std::optional<Scene> scene = read_document(document, file);
  if (!scene || file.findings.problem_count() != 0) return fail(file.findings.to_error());
  scene->origin.file = name;
  scene->notes = file.findings.notes();
  return std::move(*scene);
}

}  // namespace pliant
