#include "arrays.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "call.hpp"
#include "errors.hpp"
#include "pliant/files/read_mesh.hpp"

namespace pliant::python {
namespace {

/// Whether its elements are real numbers: no text, no complex ones, no objects.
bool has_numbers(const py::array& array) {
  const char kind = array.dtype().kind();
  return kind == 'f' || kind == 'i' || kind == 'u' || kind == 'b';
}

std::string shape_text(const py::array& array) {
  return std::string(py::str(py::tuple(array.attr("shape"))));
}

/// An array of anything.
py::array any_array_of(const py::handle& given, const char* what) {
  try {
    return py::array(py::reinterpret_borrow<py::object>(given));
  } catch (py::error_already_set& error) {
    if (!error.matches(PyExc_TypeError) && !error.matches(PyExc_ValueError)) throw;
    throw py::type_error(fmt::format("{} must be an array of numbers", what));
  }
}

template <class T>
std::vector<int> whole_numbers_as(const py::array& array, const char* what) {
  const py::array_t<T, py::array::c_style | py::array::forcecast> numbers(array);
  std::vector<int> result;
  result.reserve(static_cast<std::size_t>(numbers.size()));
  for (py::ssize_t k = 0; k < numbers.size(); ++k) {
    const T number = numbers.data()[k];
    if (!std::in_range<int>(number)) refuse(fmt::format("{}: {} is too large", what, number));
    result.push_back(static_cast<int>(number));
  }
  return result;
}

// Python's own whole numbers, of any size.
std::vector<int> whole_objects_of(const py::array& array, const char* what) {
  std::vector<int> result;
  for (const py::handle number : array.attr("flat")) {
    if (!PyLong_Check(number.ptr()))
      throw py::type_error(fmt::format("{} must be an array of whole numbers", what));
    int overflow = 0;
    const long long own = PyLong_AsLongLongAndOverflow(number.ptr(), &overflow);
    if (overflow != 0 || !std::in_range<int>(own))
      refuse(fmt::format("{}: {} is too large", what, std::string(py::str(number))));
    result.push_back(static_cast<int>(own));
  }
  return result;
}

// Whole numbers, exact, of an array of this rank.
std::vector<int> whole_numbers_of(const py::handle& given, const char* what, py::ssize_t rank) {
  const py::array array = any_array_of(given, what);
  const char kind = array.dtype().kind();
  if (array.size() > 0 && kind != 'i' && kind != 'u' && kind != 'O')
    throw py::type_error(fmt::format("{} must be an array of whole numbers", what));
  if (array.ndim() != rank)
    refuse(fmt::format("{} must have the shape {}, not {}", what, rank == 2 ? "(F, k)" : "(n,)",
                       shape_text(array)));
  if (kind == 'O') return whole_objects_of(array, what);
  return kind == 'u' ? whole_numbers_as<std::uint64_t>(array, what)
                     : whole_numbers_as<std::int64_t>(array, what);
}

void add_faces(Mesh& mesh, const py::object& faces) {
  if (py::isinstance<py::array>(faces) && py::array(faces).dtype().kind() != 'O') {
    mesh.corner_vertices = whole_numbers_of(faces, "faces", 2);
    const py::array array(faces);
    mesh.face_sizes.assign(static_cast<std::size_t>(array.shape(0)),
                           static_cast<int>(array.shape(1)));
    return;
  }
  if (!py::hasattr(faces, "__iter__"))
    throw py::type_error("faces must be an array (F, k) or a sequence of faces, not " +
                         std::string(py::repr(faces)));
  for (const py::handle face : faces) {
    const std::vector<int> corners = whole_numbers_of(face, "a face", 1);
    mesh.face_sizes.push_back(static_cast<int>(corners.size()));
    mesh.corner_vertices.insert(mesh.corner_vertices.end(), corners.begin(), corners.end());
  }
}

void add_uvs(Mesh& mesh, const py::object& uvs, const py::object& corner_uvs) {
  if (uvs.is_none()) {
    if (!corner_uvs.is_none()) refuse("corner_uvs needs uvs");
    mesh.corner_uvs.assign(mesh.corner_vertices.size(), -1);
    return;
  }
  const Numbers numbers(array_of(uvs, "uvs"));
  if (numbers.ndim() != 2 || numbers.shape(1) != 2)
    refuse("uvs must have the shape (V, 2), not " + shape_text(numbers));
  for (py::ssize_t k = 0; k < numbers.shape(0); ++k)
    mesh.uvs.push_back({numbers.at(k, 0), numbers.at(k, 1)});
  if (!corner_uvs.is_none()) {
    mesh.corner_uvs = whole_numbers_of(corner_uvs, "corner_uvs", 1);
    return;
  }
  if (static_cast<Eigen::Index>(mesh.uvs.size()) != mesh.positions.rows())
    refuse(fmt::format("uvs: {} for {} vertices; corner_uvs says which corner has which",
                       mesh.uvs.size(), mesh.positions.rows()));
  mesh.corner_uvs = mesh.corner_vertices;
}

void add_attributes(Mesh& mesh, const py::dict& attributes) {
  for (const auto& [name, values] : attributes) {
    if (!py::isinstance<py::str>(name))
      throw py::type_error("the name of an attribute must be a text, not " +
                           std::string(py::repr(name)));
    const std::string own = text_of(name);
    if (own.empty()) refuse("an attribute must have a name");
    const py::array array = array_of(values, "attributes");
    if (array.ndim() != 1)
      refuse(fmt::format("the attribute {} must have the shape (V,), not {}", printable(own),
                         shape_text(array)));
    mesh.attributes.push_back({own, numbers_of(array)});
  }
}

SharedMesh checked(Mesh mesh) {
  const Result<void> sound = check_mesh(mesh);
  if (!sound) raise(sound.error());
  return {std::make_shared<const Mesh>(std::move(mesh))};
}

SharedMesh mesh_of(const py::object& positions, const py::object& faces, const py::object& uvs,
                   const py::object& corner_uvs, const py::dict& attributes) {
  Mesh mesh;
  mesh.positions = field_of(positions, "positions");
  add_faces(mesh, faces);
  add_uvs(mesh, uvs, corner_uvs);
  add_attributes(mesh, attributes);
  return checked(std::move(mesh));
}

// -- Pickles: all members of a mesh, in their order
// -------------------------------------------------

using Bytes = std::vector<py::bytes>;
using Names = std::pair<Bytes, std::vector<int>>;
using Attributes = std::vector<std::pair<py::bytes, std::vector<double>>>;

py::tuple members_of(const Mesh& mesh) {
  const auto& [positions, uvs, sizes, vertices, corner_uvs, normals, materials, groups, object,
               left_out, attributes, first, numbers] = mesh;
  const auto names = [](const FaceNames& own) {
    return Names{Bytes(own.names.begin(), own.names.end()), own.of_faces};
  };
  Attributes values;
  for (const VertexAttribute& each : attributes) values.emplace_back(each.name, each.values);
  return py::make_tuple(copy_of(positions), uvs, sizes, vertices, corner_uvs, normals,
                        names(materials), names(groups), py::bytes(object), py::bytes(left_out),
                        values, first, numbers);
}

SharedMesh mesh_of_members(const py::object& positions, std::vector<std::array<double, 2>> uvs,
                           std::vector<int> sizes, std::vector<int> vertices,
                           std::vector<int> corner_uvs, std::vector<int> normals,
                           const Names& materials, const Names& groups, std::string object,
                           std::string left_out, const Attributes& attributes, int first,
                           std::vector<int> numbers) {
  const auto names = [](const Names& own) {
    return FaceNames{{own.first.begin(), own.first.end()}, own.second};
  };
  std::vector<VertexAttribute> values;
  for (const auto& [name, each] : attributes) values.push_back({name, each});
  return checked({field_of(positions, "positions"), std::move(uvs), std::move(sizes),
                  std::move(vertices), std::move(corner_uvs), std::move(normals), names(materials),
                  names(groups), std::move(object), std::move(left_out), std::move(values), first,
                  std::move(numbers)});
}

template <class T>
py::array view_of_numbers(const std::vector<T>& numbers, const py::object& owner) {
  return view_of(py::array_t<T>(static_cast<py::ssize_t>(numbers.size()), numbers.data(), owner));
}

void add_mesh(Module& module) {
  using py::arg;
  Class<SharedMesh> mesh(module, "Mesh", py::module_local(), R"(A polygon mesh in memory.

`positions` (V, 3) [length]; `faces` whole numbers (F, k), or a sequence of sequences; `uvs` (V, 2),
or (T, 2) with `corner_uvs`, one index a corner in the order of the faces, -1: none; `attributes`
NAME -> (V,). Arrays are copied in exactly. Immutable. Raises InvalidInput for what is wrong.)");
  mesh.def(py::init(&mesh_of), arg("positions"), arg("faces"), arg("uvs") = py::none(),
           py::kw_only(), arg("corner_uvs") = py::none(), arg("attributes") = py::dict());
  mesh.def_property_readonly(
      "positions",
      [](const py::object& own) { return view_of(own.cast<SharedMesh&>().mesh->positions, own); },
      "(V, 3) float64, read-only [length].");
  mesh.def_property_readonly(
      "uvs",
      [](const py::object& own) {
        const auto& uvs = own.cast<SharedMesh&>().mesh->uvs;
        const std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(uvs.size()), 2};
        return view_of(py::array_t<double>(shape, uvs.empty() ? nullptr : uvs.front().data(), own));
      },
      "(T, 2) float64, read-only.");
  const auto add_view = [&](const char* name, std::vector<int> Mesh::*member, const char* meaning) {
    mesh.def_property_readonly(
        name,
        [member](const py::object& own) {
          return view_of_numbers((*own.cast<SharedMesh&>().mesh).*member, own);
        },
        meaning);
  };
  add_view("face_sizes", &Mesh::face_sizes, "(F,) int32, read-only: the corners of each face.");
  add_view("corner_vertices", &Mesh::corner_vertices,
           "(C,) int32, read-only: the vertex of each corner.");
  add_view("corner_uvs", &Mesh::corner_uvs,
           "(C,) int32, read-only: the index into `uvs` of each corner, -1: none.");
  mesh.def_property_readonly(
      "attributes",
      [](const py::object& own) {
        py::dict attributes;
        for (const VertexAttribute& attribute : own.cast<SharedMesh&>().mesh->attributes)
          attributes[name_text(attribute.name)] = view_of_numbers(attribute.values, own);
        return attributes;
      },
      "NAME -> (V,) float64, read-only; a new dict.");
  mesh.def("__eq__", [](const SharedMesh& a, const py::object& b) -> py::object {
    if (!py::isinstance<SharedMesh>(b))
      return py::reinterpret_borrow<py::object>(Py_NotImplemented);
    return py::bool_(a == b.cast<SharedMesh&>());
  });
  mesh.def("__hash__", [](const SharedMesh& own) {
    return py::hash(py::make_tuple(own.mesh->positions.rows(), own.mesh->face_sizes.size()));
  });
  mesh.def("__repr__", [](const SharedMesh& own) {
    return fmt::format("<pliant.Mesh of {} vertices, {} faces>", own.mesh->positions.rows(),
                       own.mesh->face_sizes.size());
  });
  mesh.def("__copy__", [](const SharedMesh& own) { return own; });
  mesh.def("__deepcopy__", [](const SharedMesh& own, const py::dict&) { return own; });
  mesh.def("__reduce__", [](const SharedMesh& own) {
    return py::make_tuple(class_named("make_mesh"), members_of(*own.mesh));
  });
}

}  // namespace

py::array array_of(const py::handle& given, const char* what) {
  const py::array array = any_array_of(given, what);
  if (array.dtype().kind() == 'O') return class_named("array")(what, array);
  if (!has_numbers(array) && array.size() > 0)
    throw py::type_error(fmt::format("{} must be an array of numbers", what));
  return array;
}

py::array_t<double> frames_of(const py::handle& given) {
  const Numbers frames(array_of(given, "frames"));
  if (frames.ndim() > 1)
    throw py::type_error("frames must be a number or an array (n,), not of the shape " +
                         shape_text(frames));
  for (py::ssize_t k = 0; k < frames.size(); ++k)
    if (!std::isfinite(frames.data()[k])) throw py::value_error("frames must be finite numbers");
  return frames;
}

py::array view_of(py::array array, const py::object&) {
  array.attr("flags").attr("writeable") = false;
  return array;
}

py::array view_of(const Field& field, const py::object& owner) {
  const py::ssize_t rows = field.rows(), size = sizeof(double);
  return view_of(
      py::array_t<double>({rows, py::ssize_t{3}}, {size, size * rows}, field.data(), owner));
}

py::array copy_of(const Field& field) {
  py::array_t<double> array({static_cast<py::ssize_t>(field.rows()), py::ssize_t{3}});
  auto numbers = array.mutable_unchecked<2>();
  for (py::ssize_t row = 0; row < field.rows(); ++row)
    for (py::ssize_t c = 0; c < 3; ++c) numbers(row, c) = field(row, c);
  return view_of(array);
}

Field field_of(const py::handle& given, const char* what) {
  const Numbers numbers(array_of(given, what));
  if (numbers.ndim() != 2 || numbers.shape(1) != 3)
    refuse(fmt::format("{} must have the shape (n, 3), not {}", what, shape_text(numbers)));
  Field field(numbers.shape(0), 3);
  const auto from = numbers.unchecked<2>();
  for (py::ssize_t row = 0; row < field.rows(); ++row)
    for (py::ssize_t c = 0; c < 3; ++c) field(row, c) = from(row, c);
  return field;
}

std::vector<double> numbers_of(const py::handle& given) {
  const Numbers numbers(array_of(given, "values"));
  return {numbers.data(), numbers.data() + numbers.size()};
}

void add_arrays(Module& module) {
  add_mesh(module);
  module.def("mesh_of_members", &mesh_of_members);
  module.def("read_mesh", [](const std::string& file, const std::string& object, int uv_set) {
    return SharedMesh{std::make_shared<const Mesh>(run_once([&](const StopRequest& should_stop) {
      return read_mesh(file, object, uv_set, {}, should_stop);
    }))};
  });
}

}  // namespace pliant::python
