#include "parts.hpp"

#include <array>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "arrays.hpp"
#include "call.hpp"
#include "curves.hpp"
#include "custom.hpp"
#include "errors.hpp"
#include "pliant/scene/format/description.hpp"

namespace pliant::python {
namespace {

// -- Names
// -----------------------------------------------------------------------------------------

/// The name of an attribute in Python: in snake_case, with `_` if it is a keyword.
std::string python_name(std::string_view attribute) {
  std::string name;
  for (const char c : attribute) {
    if (c >= 'A' && c <= 'Z') name += '_';
    name += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  if (name == "yield" || name == "from") name += '_';
  return name;
}

// -- Values: C++ to Python
// -------------------------------------------------------------------------

template <class T>
struct OptionalOf {};
template <class T>
struct OptionalOf<std::optional<T>> {
  using type = T;
};
template <class T>
inline constexpr bool is_optional = requires {
  typename OptionalOf<T>::type;
};

py::str word_object(std::span<const std::string_view> words, int value) {
  return py::str(std::string(words[static_cast<std::size_t>(value)]));
}

template <class T>
py::object object_of(const Attribute& attribute, const T& value) {
  if constexpr (is_optional<T>) {
    return value ? object_of(attribute, *value) : py::none();
  } else if constexpr (std::is_same_v<T, Edges>) {
    const auto word = [&](Edge edge) {
      return word_object(attribute.words, static_cast<int>(edge));
    };
    return py::make_tuple(word(value.u0), word(value.u1), word(value.v0), word(value.v1));
  } else if constexpr (std::is_enum_v<T>) {
    return word_object(attribute.words, static_cast<int>(value));
  } else if constexpr (std::is_same_v<T, bool>) {
    if (!attribute.words.empty()) return word_object(attribute.words, value ? 1 : 0);
    return py::bool_(value);
  } else if constexpr (std::is_same_v<T, Channel<1>> || std::is_same_v<T, Channel<3>> ||
                       std::is_same_v<T, Switch>) {
    return channel_object(value);
  } else if constexpr (std::is_same_v<T, PositionChannel>) {
    if (value.path() != nullptr) return py::cast(PathPosition{value});
    return channel_object(*value.channel());
  } else if constexpr (std::is_same_v<T, TangentChannel>) {
    return std::visit([](const auto& channel) { return channel_object(channel); }, value);
  } else if constexpr (std::is_same_v<T, std::vector<std::string>> ||
                       std::is_same_v<T, std::vector<int>>) {
    return py::tuple(py::cast(value));
  } else if constexpr (std::is_same_v<T, std::array<double, 2>>) {
    return py::make_tuple(value[0], value[1]);
  } else if constexpr (std::is_same_v<T, std::array<double, 3>>) {
    return value_object<3>(value);
  } else if constexpr (std::is_same_v<T, std::string>) {
    return name_text(value);
  } else {
    return py::cast(value);
  }
}

// -- Values: Python to C++, as the classes of parts have made them
// ----------------------------------

template <int D>
Channel<D> channel_of(const py::handle& value) {
  if (py::isinstance<AnyCurve>(value)) return std::get<Curve<D>>(value.cast<AnyCurve&>().curve);
  if constexpr (D == 1)
    return value.cast<double>();
  else
    return value.cast<Value<3>>();
}

int index_of(std::span<const std::string_view> words, const py::handle& value) {
  const auto word = value.cast<std::string>();
  const auto found = std::find(words.begin(), words.end(), word);
  return found == words.end() ? 0 : static_cast<int>(found - words.begin());
}

template <class T>
void take(const Attribute& attribute, const py::handle& value, T& to) {
  if constexpr (is_optional<T>) {
    if (value.is_none())
      to.reset();
    else
      take(attribute, value, to.emplace());
  } else if constexpr (std::is_same_v<T, Edges>) {
    const auto edges = value.cast<py::tuple>();
    Edge* const places[] = {&to.u0, &to.u1, &to.v0, &to.v1};
    for (std::size_t k = 0; k < 4; ++k)
      *places[k] = static_cast<Edge>(index_of(attribute.words, edges[k]));
  } else if constexpr (std::is_enum_v<T>) {
    to = static_cast<T>(index_of(attribute.words, value));
  } else if constexpr (std::is_same_v<T, bool>) {
    to = attribute.words.empty() ? value.cast<bool>() : index_of(attribute.words, value) != 0;
  } else if constexpr (std::is_same_v<T, Channel<1>>) {
    to = channel_of<1>(value);
  } else if constexpr (std::is_same_v<T, Channel<3>>) {
    to = channel_of<3>(value);
  } else if constexpr (std::is_same_v<T, Switch>) {
    if (py::isinstance<AnyCurve>(value))
      to = Switch(std::get<Curve<1>>(value.cast<AnyCurve&>().curve));
    else
      to = Switch(value.cast<bool>());
  } else if constexpr (std::is_same_v<T, PositionChannel>) {
    if (py::isinstance<PathPosition>(value))
      to = value.cast<PathPosition&>().position;
    else
      to = PositionChannel(channel_of<3>(value));
  } else if constexpr (std::is_same_v<T, TangentChannel>) {
    const bool is_curve = py::isinstance<AnyCurve>(value);
    const bool is_vector = is_curve
                               ? std::holds_alternative<Curve<3>>(value.cast<AnyCurve&>().curve)
                               : py::isinstance<py::tuple>(value);
    if (is_vector)
      to = channel_of<3>(value);
    else
      to = channel_of<1>(value);
  } else if constexpr (std::is_same_v<T, std::string>) {
    to = text_of(value);
  } else {
    to = value.cast<T>();
  }
}

// -- Rows
// ------------------------------------------------------------------------------------------

/// The values of a part, read row by row into a thing; what the part does not have stays.
struct Reader {
  py::dict values;

  void operator()(const Attribute&) const {}
  template <class T>
  void operator()(const Attribute& attribute, T& member) const {
    const std::string name = python_name(attribute.name);
    if (values.contains(name.c_str())) take(attribute, values[name.c_str()], member);
  }
  void operator()(const Attribute& attribute, Falloff& member) const {
    const py::object value = values[python_name(attribute.name).c_str()];
    if (py::isinstance<py::str>(value)) take<Falloff>(attribute, value, member);
  }
};

/// The values of a thing, written row by row into a part.
struct Writer {
  py::dict values;

  void operator()(const Attribute&) const {}
  template <class T>
  void operator()(const Attribute& attribute, const T& member) const {
    values[python_name(attribute.name).c_str()] = object_of(attribute, member);
  }
};

template <class T>
constexpr const char* kind_name() {
  if constexpr (is_optional<T>)
    return kind_name<typename OptionalOf<T>::type>();
  else if constexpr (std::is_same_v<T, Edges>)
    return "edges";
  else if constexpr (std::is_same_v<T, Falloff>)
    return "falloff";
  else if constexpr (std::is_enum_v<T>)
    return "word";
  else if constexpr (std::is_same_v<T, bool>)
    return "boolean";
  else if constexpr (std::is_same_v<T, double>)
    return "number";
  else if constexpr (std::is_unsigned_v<T>)
    return "unsigned integer";
  else if constexpr (std::is_integral_v<T>)
    return "integer";
  else if constexpr (std::is_same_v<T, std::string>)
    return "text";
  else if constexpr (std::is_same_v<T, std::vector<std::string>>)
    return "names";
  else if constexpr (std::is_same_v<T, std::vector<int>>)
    return "integers";
  else if constexpr (std::is_same_v<T, std::array<double, 2>>)
    return "pair";
  else if constexpr (std::is_same_v<T, std::array<double, 3>>)
    return "vector";
  else if constexpr (std::is_same_v<T, Channel<1>>)
    return "channel";
  else if constexpr (std::is_same_v<T, Channel<3>>)
    return "vector channel";
  else if constexpr (std::is_same_v<T, Switch>)
    return "switch";
  else if constexpr (std::is_same_v<T, PositionChannel>)
    return "position";
  else
    return "tangent";
}

/// A row of the table for each row that describes a thing.
struct RowLister {
  py::dict rows;

  void operator()(const Attribute&) const {}
  template <class T>
  void operator()(const Attribute& attribute, const T& member) const {
    py::list words;
    for (const std::string_view word : attribute.words) words.append(std::string(word));
    std::string kind = kind_name<T>();
    if (kind == "boolean" && !attribute.words.empty()) kind = "word";
    if (kind == "text" && attribute.syntax == Syntax::Path) kind = "path";
    const std::string name = python_name(attribute.name);
    rows[name.c_str()] = class_named("Row")(
        name, std::string(attribute.name), kind, is_optional<T>, py::tuple(words),
        object_of(attribute, member), std::string(attribute.unit), attribute.range.to_text(),
        std::string(attribute.meaning), std::string(attribute.absent),
        attribute.need == Need::Required);
  }
};

/// Calls `row` for each row of a surface, but for its shape's and its cache's.
template <class Row, class Of>
void describe_surface(Row&& row, Of& surface) {
  describe(row, surface);
  describe(row, surface.transform);
  describe(row, surface.material);
  describe(row, surface.tangents);
  describe(row, surface.solver);
  describe(row, surface.reading);
}

/// The same of a force of a kind.
template <class Row, class Of, class Kind>
void describe_force(Row&& row, Of& force, Kind& kind) {
  using Plain = std::remove_const_t<Kind>;
  describe(row, force);
  Description<Force>::rows_of<Plain>(row, force);
  describe(row, kind);
}

template <class Row, class Of>
void describe_collider(Row&& row, Of& collider) {
  describe(row, collider);
  describe(row, collider.transform);
}

std::string capital(std::string_view name) {
  std::string text(name);
  text.front() = static_cast<char>(text.front() - 'a' + 'A');
  return text;
}

/// The force that a kind has if nothing is given.
template <class Kind>
Force standard_force() {
  Force force;
  if constexpr (requires { Description<Kind>::magnitude; })
    force.magnitude = Description<Kind>::magnitude;
  force.kind = Kind{};
  return force;
}

py::dict table() {
  py::dict all;
  const auto add = [&](const std::string& name, std::string_view meaning, auto&& describe_it) {
    RowLister lister;
    describe_it(lister);
    all[name.c_str()] = py::make_tuple(std::string(meaning), lister.rows);
  };
  const auto add_plain = [&](const std::string& name, std::string_view meaning, auto thing) {
    add(name, meaning, [&](auto& row) { describe(row, thing); });
  };
  add_plain("Scene", Description<Scene>::meaning, Scene{});
  Surface surface;
  add("Surface", Description<Surface>::meaning, [&](auto& row) {
    describe_surface(row, surface);
    describe(row, surface.cache);
  });
  add_plain("Grid", Description<SheetOf<Surface>>::meaning, GridSheet{.columns = 3, .rows = 3});
  add_plain("MeshFile", "A polygon mesh from a file.", MeshFile{});
  add_plain("Subdivision", "How a cage becomes a subdivision surface.", Subdivision{});
  add_plain("Nurbs", "A surface of control points.", NurbsNet{});
  add_plain("Map", Description<MaterialMap>::meaning, MaterialMap{});
  add_plain("Hold", Description<Hold>::meaning, Hold{});
  add_plain("Group", Description<Group>::meaning, Group{});
  Collider collider;
  ShapeCache cache;
  add("Collider", Description<Collider>::meaning, [&](auto& row) {
    describe_collider(row, collider);
    describe(row, cache);
  });
  const auto add_force = [&]<class Kind>(const Kind& kind) {
    Force force = standard_force<Kind>();
    add(capital(Description<Kind>::element), Description<Kind>::meaning,
        [&](auto& row) { describe_force(row, force, kind); });
  };
  [&]<class... Kinds>(std::variant<Kinds...>*) {
    (add_force(Kinds{}), ...);
  }(static_cast<decltype(Force::kind)*>(nullptr));
  const auto add_solid = [&]<class Kind>(const Kind& kind) {
    if constexpr (!std::is_same_v<Kind, ClosedMesh>)
      add_plain(capital(Description<Kind>::element), Description<Kind>::meaning, kind);
  };
  [&]<class... Kinds>(std::variant<Kinds...>*) {
    (add_solid(Kinds{}), ...);
  }(static_cast<decltype(Collider::shape)*>(nullptr));
  return all;
}

// -- Parts
// -----------------------------------------------------------------------------------------

bool is_a(const py::handle& part, const char* name) {
  return py::isinstance(part, class_named(name));
}

py::dict values_of(const py::handle& part) { return part.attr("__dict__"); }

std::string text_at(const py::dict& values, const char* name) {
  return values[name].cast<std::string>();
}

/// Calls `read(thing)` and names the part if it raises.
template <class T>
T part_of(const py::handle& part) {
  T thing;
  describe(Reader{values_of(part)}, thing);
  return thing;
}

NurbsNet net_of(const py::handle& part) {
  const py::dict values = values_of(part);
  NurbsNet net = part_of<NurbsNet>(part);
  const py::array_t<double> points = py::object(values["points"]);
  net.u.count = static_cast<int>(points.shape(1));
  net.v.count = static_cast<int>(points.shape(0));
  net.points = field_of(points.attr("reshape")(-1, 3), "points");
  const auto numbers = [&](const char* name) {
    const py::object value = values[name];
    return value.is_none() ? std::vector<double>() : numbers_of(value);
  };
  net.weights = numbers("weights");
  net.u.knots = numbers("knots_u");
  net.v.knots = numbers("knots_v");
  const std::string wrap = text_at(values, "wrap");
  net.u.is_closed = wrap.find('u') != std::string::npos;
  net.v.is_closed = wrap.find('v') != std::string::npos;
  return net;
}

ShapeSamples samples_of(const py::handle& array) {
  const py::array_t<double, py::array::c_style> numbers(py::reinterpret_borrow<py::object>(array));
  std::vector<Field> samples;
  for (py::ssize_t k = 0; k < numbers.shape(0); ++k)
    samples.push_back(field_of(numbers[py::int_(k)], "cache"));
  return ShapeSamples(std::move(samples));
}

/// The cache of a part, a file or an array.
ShapeCache cache_of(const py::dict& values) {
  ShapeCache cache;
  const py::object file = values["cache"];
  if (py::isinstance<py::str>(file))
    cache.path = text_of(file);
  else
    cache.samples = samples_of(file);
  const py::object first = values["cache_start"];
  if (!first.is_none()) cache.first = first.cast<double>();
  return cache;
}

/// The parts of a list of a part. Raises TypeError for others.
py::list listed(const py::handle& part, const char* name) { return part.attr("_list")(name); }

/// Whether the values of a map or hold have the shape that is theirs; how many there are is checked
/// with the scene.
bool has_own_shape(const py::array& values, const Surface& surface) {
  const auto is_of_rows = [&](int columns, int rows) {
    return values.size() != py::ssize_t{columns} * rows ||
           (values.ndim() == 2 && values.shape(0) == rows);
  };
  if (const auto* const sheet = std::get_if<GridSheet>(&surface.shape))
    return is_of_rows(sheet->columns, sheet->rows);
  if (values.ndim() == 1) return true;
  const auto* const net = std::get_if<NurbsNet>(&surface.shape);
  return net && is_of_rows(net->u.count, net->v.count);
}

/// The maps or holds of a surface.
template <class T>
std::vector<T> valued_parts_of(const py::handle& part, const char* list, const Surface& surface) {
  std::vector<T> things;
  for (const py::handle own : listed(part, list)) {
    things.push_back(part_of<T>(own));
    const py::object given = values_of(own)["values"];
    if (given.is_none()) continue;
    const py::array values(given);
    if (!has_own_shape(values, surface))
      raise(Error{.message = fmt::format(
                      "{}.{}[{}]: values must have the shape (rows, columns) of a grid or of the "
                      "points of a net, or (V,) of a mesh, not {}",
                      surface.name, list, things.size() - 1,
                      std::string(py::str(values.attr("shape"))))});
    things.back().values = numbers_of(values);
  }
  return things;
}

Surface surface_of(const py::handle& part) {
  const py::dict values = values_of(part);
  Surface surface;
  describe_surface(Reader{values}, surface);
  surface.cache = cache_of(values);
  const py::object shape = values["shape"];
  if (is_a(shape, "Grid"))
    surface.shape = part_of<GridSheet>(shape);
  else if (is_a(shape, "MeshFile"))
    surface.shape = part_of<MeshFile>(shape);
  else if (is_a(shape, "Nurbs"))
    surface.shape = net_of(shape);
  else
    surface.shape = *shape.cast<SharedMesh&>().mesh;
  surface.maps = valued_parts_of<MaterialMap>(part, "maps", surface);
  surface.holds = valued_parts_of<Hold>(part, "holds", surface);
  const py::object subdivision = values["subdivision"];
  if (!subdivision.is_none()) surface.subdivision = part_of<Subdivision>(subdivision);
  return surface;
}

Force force_of(const py::handle& part, Asking* owner) {
  const py::dict values = values_of(part);
  Force force;
  const auto try_kind = [&]<class Kind>(Kind kind) {
    if (!is_a(part, capital(Description<Kind>::element).c_str())) return;
    describe_force(Reader{values}, force, kind);
    if constexpr (std::is_same_v<Kind, CustomForce>) kind = custom_force_of(values, owner);
    force.kind = std::move(kind);
  };
  [&]<class... Kinds>(std::variant<Kinds...>*) {
    (try_kind(Kinds{}), ...);
  }(static_cast<decltype(Force::kind)*>(nullptr));
  force.group = text_at(values, "group");
  const py::object falloff = values["falloff"];
  if (py::isinstance<AnyCurve>(falloff))
    force.falloff_curve = std::get<Curve<1>>(falloff.cast<AnyCurve&>().curve);
  return force;
}

Collider collider_of(const py::handle& part) {
  const py::dict values = values_of(part);
  Collider collider;
  describe_collider(Reader{values}, collider);
  const py::object shape = values["shape"];
  const ShapeCache cache = cache_of(values);
  const auto try_shape = [&]<class Kind>(Kind kind) {
    if constexpr (std::is_same_v<Kind, ClosedMesh>) {
      if (is_a(shape, "MeshFile"))
        kind.mesh = part_of<MeshFile>(shape);
      else if (py::isinstance<SharedMesh>(shape))
        kind.made = *shape.cast<SharedMesh&>().mesh;
      else
        return;
      kind.cache = cache;
    } else {
      if (!is_a(shape, capital(Description<Kind>::element).c_str())) return;
      if (!(cache == ShapeCache{}))
        raise(Error{.message = fmt::format("{}.{} is given, but its shape is a {}", collider.name,
                                           cache.is_empty() ? "cacheStart" : "cache",
                                           Description<Kind>::element)});
      kind = part_of<Kind>(shape);
    }
    collider.shape = std::move(kind);
  };
  [&]<class... Kinds>(std::variant<Kinds...>*) {
    (try_shape(Kinds{}), ...);
  }(static_cast<decltype(Collider::shape)*>(nullptr));
  return collider;
}

/// A new part with nothing in it yet.
py::object blank(const char* name) {
  const py::object type = class_named(name);
  return type.attr("__new__")(type);
}

template <class T>
py::object python_part(const char* name, const T& thing) {
  py::object part = blank(name);
  describe(Writer{values_of(part)}, thing);
  return part;
}

py::object array_or_none(const std::vector<double>& numbers) {
  if (numbers.empty()) return py::none();
  return view_of(py::array_t<double>(static_cast<py::ssize_t>(numbers.size()), numbers.data()));
}

/// A map or hold, with its values as they are of a grid of so many columns and rows.
template <class T>
py::object python_valued(const char* name, const T& thing, const GridSheet* sheet) {
  py::object part = python_part(name, thing);
  py::object values = array_or_none(thing.values);
  if (sheet != nullptr && !values.is_none() &&
      py::len(values) == static_cast<std::size_t>(sheet->columns) * sheet->rows)
    values = view_of(py::array(values.attr("reshape")(sheet->rows, sheet->columns)));
  values_of(part)["values"] = values;
  return part;
}

py::object python_net(const NurbsNet& net) {
  py::object part = python_part("Nurbs", net);
  const py::dict values = values_of(part);
  for (const char* const implied : {"columns", "rows"}) values.attr("pop")(implied);
  const py::array points =
      py::array(copy_of(net.points)).attr("reshape")(net.v.count, net.u.count, 3);
  values["points"] = view_of(points);
  values["weights"] = array_or_none(net.weights);
  if (!net.weights.empty())
    values["weights"] =
        view_of(py::array(values["weights"].attr("reshape")(net.v.count, net.u.count)));
  values["knots_u"] = array_or_none(net.u.knots);
  values["knots_v"] = array_or_none(net.v.knots);
  const std::string wrap = std::string(net.u.is_closed ? "u" : "") + (net.v.is_closed ? "v" : "");
  values["wrap"] = wrap.empty() ? "none" : wrap;
  return part;
}

py::object python_cache(const ShapeCache& cache) {
  if (cache.samples.is_empty()) return py::str(cache.path);
  const auto count = static_cast<py::ssize_t>(cache.samples.count());
  const auto rows = static_cast<py::ssize_t>(cache.samples[0].rows());
  py::array_t<double> array({count, rows, py::ssize_t{3}});
  auto numbers = array.mutable_unchecked<3>();
  for (py::ssize_t k = 0; k < count; ++k)
    for (py::ssize_t row = 0; row < rows; ++row)
      for (py::ssize_t axis = 0; axis < 3; ++axis)
        numbers(k, row, axis) = cache.samples[static_cast<std::size_t>(k)](row, axis);
  return view_of(array);
}

py::object python_mesh(const Mesh& mesh) {
  return py::cast(SharedMesh{std::make_shared<const Mesh>(mesh)});
}

py::object python_surface(const Surface& surface) {
  py::object part = blank("Surface");
  const py::dict values = values_of(part);
  describe_surface(Writer{values}, surface);
  describe(Writer{values}, surface.cache);
  values["cache"] = python_cache(surface.cache);
  values["shape"] = std::visit(
      [](const auto& shape) -> py::object {
        using Shape = std::decay_t<decltype(shape)>;
        if constexpr (std::is_same_v<Shape, GridSheet>)
          return python_part("Grid", shape);
        else if constexpr (std::is_same_v<Shape, MeshFile>)
          return python_part("MeshFile", shape);
        else if constexpr (std::is_same_v<Shape, Mesh>)
          return python_mesh(shape);
        else
          return python_net(shape);
      },
      surface.shape);
  const auto* const sheet = std::get_if<GridSheet>(&surface.shape);
  py::list maps, holds;
  for (const MaterialMap& map : surface.maps) maps.append(python_valued("Map", map, sheet));
  for (const Hold& hold : surface.holds) holds.append(python_valued("Hold", hold, sheet));
  values["maps"] = maps;
  values["holds"] = holds;
  values["subdivision"] =
      surface.subdivision ? python_part("Subdivision", *surface.subdivision) : py::none();
  return part;
}

py::object python_force(const Force& force, const py::object& like) {
  return std::visit(
      [&]<class Kind>(const Kind& kind) {
        py::object part = blank(capital(Description<Kind>::element).c_str());
        const py::dict values = values_of(part);
        describe_force(Writer{values}, force, kind);
        values["group"] = force.group;
        if (force.falloff_curve) values["falloff"] = py::cast(AnyCurve{*force.falloff_curve});
        if constexpr (std::is_same_v<Kind, CustomForce>) {
          const py::dict own = values_of(like[py::str(force.name)]);
          for (const char* const name : {"force", "distance", "key"}) values[name] = own[name];
        }
        return part;
      },
      force.kind);
}

py::object python_collider(const Collider& collider) {
  py::object part = blank("Collider");
  const py::dict values = values_of(part);
  describe_collider(Writer{values}, collider);
  const ShapeCache none;
  describe(Writer{values}, none);
  values["shape"] = std::visit(
      [&]<class Kind>(const Kind& shape) -> py::object {
        if constexpr (std::is_same_v<Kind, ClosedMesh>) {
          describe(Writer{values}, shape.cache);
          values["cache"] = python_cache(shape.cache);
          return shape.made ? python_mesh(*shape.made) : python_part("MeshFile", shape.mesh);
        } else {
          return python_part(capital(Description<Kind>::element).c_str(), shape);
        }
      },
      collider.shape);
  return part;
}

/// The files that a scene was read from, and what was noticed: kept by the Python scene.
struct Source {
  SceneOrigin origin;
  std::vector<SceneNote> notes;
};

template <class List>
py::list list_of(const List& things, auto&& make) {
  py::list list;
  for (const auto& thing : things) list.append(make(thing));
  return list;
}

}  // namespace

Scene scene_of(const py::object& scene, Asking* owner) {
  if (!is_a(scene, "Scene"))
    throw py::type_error("a scene must be a pliant.Scene, not " +
                         std::string(py::str(py::type::of(scene).attr("__name__"))));
  const py::dict values = values_of(scene);
  Scene result;
  describe(Reader{values}, result);
  // The library's loops over frames are for those that a file can have.
  for (const auto& [name, frame] : {std::pair("start", result.start), {"end", result.end}})
    if (frame < -largest_frame || frame > largest_frame)
      raise(Error{.message = fmt::format("scene: {}={}: must be {} to {}", name, frame,
                                         -largest_frame, largest_frame)});
  for (const py::handle part : listed(scene, "surfaces"))
    result.surfaces.push_back(surface_of(part));
  for (const py::handle part : listed(scene, "forces"))
    result.forces.push_back(force_of(part, owner));
  for (const py::handle part : listed(scene, "groups"))
    result.groups.push_back(part_of<Group>(part));
  for (const py::handle part : listed(scene, "colliders"))
    result.colliders.push_back(collider_of(part));
  const py::object source = scene.attr("_source");
  if (!source.is_none()) {
    result.origin = source.cast<Source&>().origin;
    result.notes = source.cast<Source&>().notes;
  }
  return result;
}

py::object python_scene(Scene scene, const py::object& like) {
  py::object result = blank("Scene");
  const py::dict values = values_of(result);
  describe(Writer{values}, scene);
  values["surfaces"] = list_of(scene.surfaces, python_surface);
  values["forces"] =
      list_of(scene.forces, [&](const Force& force) { return python_force(force, like); });
  values["groups"] =
      list_of(scene.groups, [](const Group& group) { return python_part("Group", group); });
  values["colliders"] = list_of(scene.colliders, python_collider);
  values["_source"] = scene.origin.file.empty()
                          ? py::object(py::none())
                          : py::cast(Source{std::move(scene.origin), std::move(scene.notes)});
  return result;
}

void add_parts(Module& module) {
  Class<Source>(module, "Source", py::module_local())
      .def_property_readonly("file",
                             [](const Source& source) { return name_text(source.origin.file); })
      .def_property_readonly("notes",
                             [](const Source& source) {
                               return py::tuple(list_of(source.notes, [](const SceneNote& note) {
                                 return problem_object("note", note.message, note.file, note.line);
                               }));
                             })
      .def("line_of",
           [](const Source& source, const std::string& name, const std::string& attribute) {
             return source.origin.place_of(name, attribute).line;
           });
  module.def("table", table);
}

}  // namespace pliant::python
