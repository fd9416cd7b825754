#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "pliant/scene/reading/net.hpp"
#include "pliant/scene/reading/read_elements.hpp"

namespace pliant::xml {
namespace {

/// An element that a surface contains at most once, with its table.
struct Part {
  Table table;
  int line = 0;  ///< of the element, 0: absent
};

class SurfaceReader {
 public:
  SurfaceReader(const Element& element, SceneFile& file)
      : element_(element),
        file_(file),
        own_(table_of(surface_)),
        transform_{table_of(surface_.transform)},
        material_{table_of(surface_.material)},
        tangents_{table_of(surface_.tangents)},
        solver_{table_of(surface_.solver)} {}

  Surface read();

 private:
  void read_grid(const Element& element);
  void read_mesh(const Element& element, bool is_cage);
  void read_net(const Element& element);
  void locate_cache(const Element& element, Table& table, CacheFile& cache);
  void read_part(const Element& element, Part& part);
  void read_material(const Element& element);
  void read_map(const Element& element);
  bool takes_part(const Element& element, Part& part);
  void read_own_animate(const Element& element);
  bool takes_shape(const Element& element);
  void refuse_parts_of_driven();
  std::string title() const;  ///< `<surface> "sheet"`

  const Element& element_;
  SceneFile& file_;
  Surface surface_;  // the tables refer to it
  Table own_;
  Part transform_;
  Part material_;
  Part tangents_;
  Part solver_;
  int shape_line_ = 0;
};

Surface SurfaceReader::read() {
  read_attributes(element_, own_, file_.findings);
  const Child children[] = {
      {"grid", [&](const Element& child) { read_grid(child); }},
      {"mesh", [&](const Element& child) { read_mesh(child, false); }},
      {"nurbs", [&](const Element& child) { read_net(child); }},
      {"subdivision", [&](const Element& child) { read_mesh(child, true); }},
      {"transform", [&](const Element& child) { read_part(child, transform_); }},
      {"material", [&](const Element& child) { read_material(child); }},
      {"tangents", [&](const Element& child) { read_part(child, tangents_); }},
      {"solver", [&](const Element& child) { read_part(child, solver_); }},
      {"animate", [&](const Element& child) { read_own_animate(child); }},
  };
  const bool all_known = read_children(element_, children, file_.findings);
  if (shape_line_ == 0 && all_known)
    file_.findings.add_problem(
        element_.line(),
        fmt::format("{} has no shape: one <grid>, <mesh>, <nurbs> or <subdivision> is required",
                    title()));
  refuse_parts_of_driven();

  record_element(element_, surface_.name, own_, file_);
  if (!surface_.name.empty()) {
    for (const Part* part : {&transform_, &material_, &tangents_, &solver_})
      record(surface_.name, part->table, file_);
  }
  return std::move(surface_);
}

std::string SurfaceReader::title() const {
  return surface_.name.empty() ? tag(element_)
                               : fmt::format("{} {}", tag(element_), in_quotes(surface_.name));
}

/// Whether this is the surface's first shape. A second one is a problem, but is still read to
/// report its own problems.
bool SurfaceReader::takes_shape(const Element& element) {
  if (shape_line_ == 0) {
    shape_line_ = element.line();
    return true;
  }
  file_.findings.add_problem(element.line(),
                             fmt::format("{} has two shapes; the first is at {}", title(),
                                         file_.findings.title_of(shape_line_, element.line())));
  return false;
}

void SurfaceReader::read_grid(const Element& element) {
  const bool is_first = takes_shape(element);
  GridSheet grid;
  CacheFile cache;
  Table table = table_of(grid, cache);
  read_attributes(element, table, file_.findings);
  locate_cache(element, table, cache);
  read_children(element, {}, file_.findings);
  if (!is_first) return;
  surface_.shape = grid;
  surface_.cache = cache;
  if (!surface_.name.empty()) record(surface_.name, table, file_);
}

void SurfaceReader::read_mesh(const Element& element, bool is_cage) {
  const bool is_first = takes_shape(element);
  MeshFile mesh;
  MeshReading reading;
  CacheFile cache;
  Subdivision subdivision;
  Table table =
      is_cage ? table_of(mesh, reading, cache, subdivision) : table_of(mesh, reading, cache);
  read_attributes(element, table, file_.findings);
  locate_cache(element, table, cache);
  locate_file(element, *find(table, "file"), surface_.name, "file", mesh.path, file_);
  mesh.root = (file_.root.empty() ? file_.folder_at(element.line()) : file_.root).string();
  if (mesh.root.empty()) mesh.root = ".";  // empty would mean the mesh's own folder
  read_children(element, {}, file_.findings);
  if (!is_first) return;
  surface_.shape = mesh;
  surface_.reading = reading;
  surface_.cache = cache;
  if (is_cage) surface_.subdivision = subdivision;
  if (!surface_.name.empty()) record(surface_.name, table, file_);
}

void SurfaceReader::locate_cache(const Element& element, Table& table, CacheFile& cache) {
  locate_file(element, *find(table, "cache"), surface_.name, "cache", cache.path, file_);
}

void SurfaceReader::read_net(const Element& element) {
  const bool is_first = takes_shape(element);
  NurbsNet net;
  Table table = table_of(net);
  read_attributes(element, table, file_.findings);
  NetReader reader(net, surface_.name, file_);
  reader.read_content(element);
  if (!is_first) return;
  surface_.shape = std::move(net);
  if (surface_.name.empty()) return;
  record(surface_.name, table, file_);
  reader.record_content();
}

/// Whether this is the first such part of the surface; reads its attributes then.
bool SurfaceReader::takes_part(const Element& element, Part& part) {
  if (part.line != 0) {
    file_.findings.add_problem(
        element.line(), fmt::format("{} has a second {}; the first is at {}", title(), tag(element),
                                    file_.findings.title_of(part.line, element.line())));
    return false;
  }
  part.line = element.line();
  read_attributes(element, part.table, file_.findings);
  return true;
}

void SurfaceReader::read_material(const Element& element) {
  if (!takes_part(element, material_)) return;
  const Child children[] = {
      {"animate",
       [&](const Element& child) {
         read_animate(child, material_.table, surface_.name, file_.findings);
       }},
      {"map", [&](const Element& child) { read_map(child); }},
  };
  read_children(element, children, file_.findings);
}

void SurfaceReader::read_map(const Element& element) {
  MaterialMap map;
  Table table = table_of(map);
  read_attributes(element, table, file_.findings);
  read_children(element, {}, file_.findings);
  for (const Slot& slot : table) {
    if (!slot.is_sound) return;
  }
  const std::string name = name_of(map.channel);
  const auto first = std::ranges::find(surface_.maps, map.channel, &MaterialMap::channel);
  if (first != surface_.maps.end())
    return file_.findings.add_problem(
        element.line(), fmt::format("{} has a second map of {}; a channel has one", title(),
                                    map_channel_words[static_cast<std::size_t>(map.channel)]));
  locate_file(element, *find(table, "file"), surface_.name, name, map.file, file_);
  surface_.maps.push_back(map);
  if (!surface_.name.empty())
    record_element(element, fmt::format("{}.{}", surface_.name, name), table, file_);
}

void SurfaceReader::read_part(const Element& element, Part& part) {
  if (!takes_part(element, part)) return;
  const Child children[] = {{"animate", [&](const Element& child) {
                               read_animate(child, part.table, surface_.name, file_.findings);
                             }}};
  read_children(element, children, file_.findings);
}

/// What drives a surface also moves it: only its shape and its transform are its own.
void SurfaceReader::refuse_parts_of_driven() {
  if (!surface_.is_driven()) return;
  const std::pair<std::string_view, const Part*> parts[] = {
      {"material", &material_}, {"tangents", &tangents_}, {"solver", &solver_}};
  for (const auto& [name, part] : parts) {
    if (part->line == 0) continue;
    file_.findings.add_problem(
        part->line,
        fmt::format("{} is driven by {} and has no <{}>; that of {} counts", title(),
                    in_quotes(surface_.driven_by), name, in_quotes(surface_.driven_by)));
  }
}

/// An <animate> directly in the surface may name a channel of any of its parts, as all names
/// differ.
void SurfaceReader::read_own_animate(const Element& element) {
  std::vector<Slot*> rows;
  for (Table* table :
       {&own_, &transform_.table, &material_.table, &tangents_.table, &solver_.table})
    for (Slot& row : *table) rows.push_back(&row);
  read_animate(element, rows, surface_.name, file_.findings);
}

}  // namespace

Surface read_surface(const Element& element, SceneFile& file) {
  return SurfaceReader(element, file).read();
}

}  // namespace pliant::xml
