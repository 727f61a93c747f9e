// Polygon meshes from and to arrays and files.

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "samples/python/arrays.h"
#include "samples/python/bindings.h"
#include "samples/spec/parse.h"
#include "sdf/error.h"
#include "subdiv/import.h"
#include "subdiv/mesh_audit.h"
#include "subdiv/tessellate.h"

namespace limn::python {
namespace {

namespace py = pybind11;

std::vector<std::int32_t> list_of(const py::object& value, const char* field) {
  const py::array_t<std::int32_t> numbers = whole_numbers_of(value, field, {-1});
  return {numbers.data(), numbers.data() + numbers.size()};
}

void add_creases(const py::object& creases, const py::object& sharpness, Mesh& mesh) {
  if (creases.is_none()) return;
  const py::array_t<std::int32_t> edges = whole_numbers_of(creases, "creases", {-1, 2});
  const py::array_t<double> sharp = numbers_of(sharpness, "sharpness", {static_cast<int>(edges.shape(0))});
  for (py::ssize_t i = 0; i < edges.shape(0); ++i) {
    if (!(sharp.at(i) >= 0.0)) throw InputError({"", "sharpness", std::to_string(sharp.at(i)), "out of range", "numbers from 0 up"});
    mesh.creases.push_back({edges.at(i, 0), edges.at(i, 1), static_cast<float>(sharp.at(i))});
  }
}

SharedMesh mesh_of(const py::object& positions, const py::object& face_sizes, const py::object& corner_vertices, const py::object& colors,
                   const py::object& creases, const py::object& sharpness) {
  Mesh mesh;
  mesh.positions = points_of_array(positions, "positions");
  mesh.face_sizes = list_of(face_sizes, "face_sizes");
  mesh.corner_vertices = list_of(corner_vertices, "corner_vertices");
  std::int64_t corners = 0;
  for (const std::int32_t size : mesh.face_sizes) {
    if (size < 3) throw InputError({"", "face_sizes", std::to_string(size), "a face has too few corners", "3 or more"});
    corners += size;
  }
  if (corners != static_cast<std::int64_t>(mesh.corner_vertices.size()))
    throw InputError({"", "corner_vertices", std::to_string(mesh.corner_vertices.size()), "does not fit face_sizes",
                      std::to_string(corners) + " of them, the sum of face_sizes"});
  if (!colors.is_none()) {
    const py::array_t<double> numbers = numbers_of(colors, "vertex_colors", {static_cast<int>(mesh.positions.size()), 3});
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
      const double* const rgb = numbers.data() + 3 * i;
      mesh.vertex_colors.emplace_back(static_cast<float>(rgb[0]), static_cast<float>(rgb[1]), static_cast<float>(rgb[2]));
    }
  }
  add_creases(creases, sharpness, mesh);
  validate(mesh, "");
  return {std::move(mesh)};
}

SharedMesh read_mesh(const std::string& file) {
  return call_unlocked([&](const Stopped&) { return SharedMesh(load_mesh(file)); });
}

SharedMesh refined(const SharedMesh& mesh, int level, const std::string& scheme, bool to_limit) {
  const RefineSettings settings{
      .scheme = scheme.empty() ? default_scheme(mesh) : parse_scheme(scheme, "", "scheme"), .level = level, .to_limit = to_limit};
  return call_unlocked([&](const Stopped&) { return SharedMesh(refine(mesh, settings)); });
}

SharedMesh tessellated(const Field& field, int level) {
  return call_unlocked([&](const Stopped&) { return SharedMesh(tessellate(field, {.level = level})); });
}

py::object optional_view(const std::vector<glm::vec3>& values, const py::object& owner) {
  if (values.empty()) return py::none();
  return view_of(values, owner);
}

void add_arrays(py::class_<SharedMesh>& type) {
  type.def_property_readonly(
          "positions", [](const py::object& self) { return view_of(self.cast<const SharedMesh&>()->positions, self); },
          "Of the vertices, world units: (n, 3) float64. Looks at the mesh's own memory.")
      .def_property_readonly(
          "face_sizes", [](const py::object& self) { return view_of(self.cast<const SharedMesh&>()->face_sizes, self); },
          "Corners of each face: (m,) int32. Looks at the mesh's own memory.")
      .def_property_readonly(
          "corner_vertices", [](const py::object& self) { return view_of(self.cast<const SharedMesh&>()->corner_vertices, self); },
          "The faces' corners one after the other, as vertices: (k,) int32. Looks at the mesh's own memory.")
      .def_property_readonly(
          "corner_normals", [](const py::object& self) { return optional_view(self.cast<const SharedMesh&>()->corner_normals, self); },
          "One for each corner: (k, 3) float32, or None. Looks at the mesh's own memory.")
      .def_property_readonly(
          "vertex_colors", [](const py::object& self) { return optional_view(self.cast<const SharedMesh&>()->vertex_colors, self); },
          "Linear RGB, one for each vertex: (n, 3) float32, or None. Looks at the mesh's own memory.");
}

}  // namespace

void bind_meshes(py::module_& module) {
  py::class_<SharedMesh> type(module, "Mesh", "A polygon mesh. Never changes.");
  add_arrays(type);
  type.def(py::init(&mesh_of), py::arg("positions"), py::arg("face_sizes"), py::arg("corner_vertices"), py::kw_only(),
           py::arg("vertex_colors") = py::none(), py::arg("creases") = py::none(), py::arg("sharpness") = py::none(),
           "positions (n, 3), world units; face_sizes (m,), corners of each face; corner_vertices (k,), the faces' corners one after the "
           "other, counter-clockwise seen from outside. vertex_colors (n, 3), linear RGB. creases (c, 2), edges by their vertices, and "
           "sharpness (c,), 10 and above infinitely sharp, make it a subdivision cage. All arrays are copied.")
      .def_property_readonly(
          "bounds", [](const SharedMesh& mesh) { return array_of(bounds(*mesh)); }, "World units: (2, 3).")
      .def("__repr__",
           [](const SharedMesh& mesh) {
             return fmt::format("<limn.Mesh: {} vertices, {} faces>", mesh->vertex_count(), mesh->face_count());
           })
      .def_property_readonly(
          "warnings", [](const SharedMesh& mesh) { return mesh->warnings; }, "What the reader repaired or left out.")
      .def("refine", refined, py::arg("level"), py::arg("scheme") = "", py::arg("to_limit") = true,
           "The cage subdivided 0 to 8 times by \"catmark\", \"loop\" or \"bilinear\" (\"\": as its faces ask for), its vertices on the "
           "limit surface.")
      .def(
          "write",
          [](const SharedMesh& mesh, const std::filesystem::path& file) { run_unlocked([&](const Stopped&) { write_mesh(*mesh, file); }); },
          py::arg("file"), "As .obj or .ply.");
  module.def("read_mesh", read_mesh, py::arg("file"));
  module.def("tessellate", tessellated, py::arg("field"), py::arg("level"));
}

}  // namespace limn::python
