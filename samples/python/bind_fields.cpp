// Fields: shapes, CSG, Python's own functions, samples on a grid, formulas.

#include <fmt/format.h>
#include <pybind11/operators.h>
#include <pybind11/stl.h>

#include <cmath>
#include <numbers>

#include "samples/python/arrays.h"
#include "samples/python/bindings.h"
#include "samples/python/grid_field.h"
#include "sdf/error.h"
#include "sdf/field_from_functions.h"
#include "sdf/shape.h"
#include "sdf/vm_field.h"

namespace limn::python {
namespace {

namespace py = pybind11;

/// A Python object that any thread may let go of.
std::shared_ptr<const py::object> shared_object(py::object object) {
  return {new py::object(std::move(object)), [](const py::object* held) {
            // At the interpreter's end there is no lock to take, and nothing to let go of.
            if (Py_IsInitialized() == 0) return;
            const py::gil_scoped_acquire locked;
            delete held;
          }};
}

double number_from(const py::handle& result, const char* field) {
  const double number = PyFloat_AsDouble(result.ptr());
  if (PyErr_Occurred() != nullptr) {
    PyErr_Clear();
    throw InputError({"", field, py::str(py::type::of(result).attr("__name__")).cast<std::string>(), "returned no number", "a float"});
  }
  if (!std::isfinite(number)) throw InputError({"", field, fmt::format("{}", number), "returned no finite number", "a finite number"});
  return number;
}

void check_callable(const py::object& function, const char* field) {
  if (PyCallable_Check(function.ptr()) == 0)
    throw InputError(
        {"", field, py::str(py::type::of(function).attr("__name__")).cast<std::string>(), "cannot be called", "a function of x, y and z"});
}

/// Calls with arrays of x, y and z; what comes back has `per_point` numbers a point, point by point.
void call_with_arrays(const py::object& function, std::span<const glm::dvec3> points, size_t per_point, const char* field, double* out) {
  std::array<py::array_t<double>, 3> at;
  for (int axis = 0; axis < 3; ++axis) {
    py::array_t<double>& numbers = at[static_cast<size_t>(axis)];
    numbers = py::array_t<double>(static_cast<py::ssize_t>(points.size()));
    double* const to = numbers.mutable_data();
    for (size_t i = 0; i < points.size(); ++i) to[i] = points[i][axis];
  }
  const py::object returned = function(at[0], at[1], at[2]);
  const auto found = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(returned);
  const size_t expected = per_point * points.size();
  const auto refused = [&](const std::string& value, const std::string& problem) {
    const std::string shape = per_point == 1 ? fmt::format("({},)", points.size()) : fmt::format("({}, {})", points.size(), per_point);
    return InputError({"", field, value, problem, "an array " + shape + " of finite numbers for arrays of as many points"});
  };
  if (!found) {
    PyErr_Clear();
    throw refused(py::str(py::type::of(returned).attr("__name__")).cast<std::string>(), "returned no array of numbers");
  }
  if (static_cast<size_t>(found.size()) != expected)
    throw refused(py::str(py::tuple(found.attr("shape"))).cast<std::string>(), "returned an array of another shape");
  std::copy_n(found.data(), expected, out);
  const double* const wrong = std::find_if(out, out + expected, [](double number) { return !std::isfinite(number); });
  if (wrong != out + expected) throw refused(fmt::format("{}", *wrong), "returned no finite number");
}

/// Of functions that take arrays.
void set_functions_of_many(const py::object& function, const py::object& gradient, FieldFunctions& functions) {
  functions.values = [held = shared_object(function)](std::span<const glm::dvec3> points, std::span<double> values) {
    const py::gil_scoped_acquire locked;
    call_with_arrays(*held, points, 1, "function", values.data());
  };
  if (gradient.is_none()) return;
  functions.gradients = [held = shared_object(gradient)](std::span<const glm::dvec3> points, std::span<glm::dvec3> gradients) {
    const py::gil_scoped_acquire locked;
    call_with_arrays(*held, points, 3, "gradient", &gradients.data()->x);
  };
}

Field field_of(const py::object& function, const py::object& bounds, double lipschitz, const py::object& gradient, bool vectorized) {
  check_callable(function, "function");
  if (!gradient.is_none()) check_callable(gradient, "gradient");
  FieldFunctions functions{.lipschitz = lipschitz, .extent = box_of(bounds, "bounds")};
  if (vectorized) {
    set_functions_of_many(function, gradient, functions);
    return field_from_functions(functions);
  }
  functions.value = [held = shared_object(function)](const glm::dvec3& p) {
    const py::gil_scoped_acquire locked;
    return number_from((*held)(p.x, p.y, p.z), "function");
  };
  if (!gradient.is_none()) {
    functions.gradient = [held = shared_object(gradient)](const glm::dvec3& p) {
      const py::gil_scoped_acquire locked;
      return vector_of((*held)(p.x, p.y, p.z), "gradient");
    };
  }
  return field_from_functions(functions);
}

Field grid_of(const py::object& values, const py::object& origin, double spacing) {
  const py::array_t<double> numbers = numbers_of(values, "values", {-1, -1, -1});
  GridSamples samples{
      .count = {numbers.shape(0), numbers.shape(1), numbers.shape(2)}, .origin = vector_of(origin, "origin"), .spacing = spacing};
  for (int axis = 0; axis < 3; ++axis)
    if (samples.count[axis] < 2)
      throw InputError({"", "values", std::to_string(samples.count[axis]), "has too few samples along an axis", "at least 2"});
  if (!(spacing > 0.0) || !std::isfinite(spacing))
    throw InputError({"", "spacing", fmt::format("{}", spacing), "is no distance", "a length above 0 in world units"});
  samples.values.assign(numbers.data(), numbers.data() + numbers.size());
  return call_unlocked([&](const Stopped&) { return field_from_grid(std::move(samples)); });
}

Field shape_of(const std::string& name, const std::map<std::string, py::object>& given) {
  std::map<std::string, ParameterInput> parameters;
  for (const auto& [key, value] : given) {
    ParameterInput& input = parameters[key];
    if (py::isinstance<py::str>(value)) {
      input.word = value.cast<std::string>();
      continue;
    }
    // Lists of points are given row by row.
    const py::array_t<double> flat = numbers_of(py::module_::import("numpy").attr("ravel")(value), key, {-1});
    input.numbers.assign(flat.data(), flat.data() + flat.size());
  }
  const ShapeDescriptor& shape = find_shape(name, "", "shape");
  return shape.make(resolve(shape.parameters, parameters));
}

Field formula_of(const std::string& text, const std::string& name) {
  VmField made = vm_field(text, name);
  if (!made.unbounded.empty())
    throw InputError({"", "function", "", made.unbounded, "a bounded surface: cut it with & limn.shape(\"box\", half=...)"});
  return std::move(made.field);
}

py::array_t<double> values_at(const Field& field, const py::object& points) {
  const std::vector<glm::dvec3> at = points_of_array(points, "points");
  py::array_t<double> values(static_cast<py::ssize_t>(at.size()));
  const std::span<double> out(values.mutable_data(), at.size());
  run_unlocked([&](const Stopped&) { FieldEvaluator(field).values(at, out); });
  return values;
}

py::array_t<double> gradients_at(const Field& field, const py::object& points) {
  const std::vector<glm::dvec3> at = points_of_array(points, "points");
  std::vector<double> values(at.size());
  std::vector<glm::dvec3> gradients(at.size());
  run_unlocked([&](const Stopped&) { FieldEvaluator(field).gradients(at, values, gradients); });
  py::array_t<double> out({static_cast<py::ssize_t>(at.size()), py::ssize_t{3}});
  for (size_t i = 0; i < at.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) out.mutable_at(static_cast<py::ssize_t>(i), axis) = gradients[i][axis];
  return out;
}

Field scaled(const Field& field, const py::object& factor) {
  if (py::isinstance<py::float_>(factor) || py::isinstance<py::int_>(factor)) return scale(field, factor.cast<double>());
  return scale(field, vector_of(factor, "scale"));
}

void add_operations(py::class_<Field>& type) {
  const auto operation = [](Csg csg) {
    return [csg](const Field& a, const Field& b, double smooth) { return combine(csg, a, b, smooth); };
  };
  type.def("union", operation(Csg::union_), py::arg("other"), py::arg("smooth") = 0.0,
           "Both together. smooth: radius of the blend, world units; 0 is sharp.")
      .def("intersection", operation(Csg::intersection), py::arg("other"), py::arg("smooth") = 0.0, "What both hold. smooth as for union.")
      .def("difference", operation(Csg::difference), py::arg("other"), py::arg("smooth") = 0.0,
           "This without the other. smooth as for union.")
      .def(
          "__or__", [](const Field& a, const Field& b) { return combine(Csg::union_, a, b); }, py::is_operator())
      .def(
          "__and__", [](const Field& a, const Field& b) { return combine(Csg::intersection, a, b); }, py::is_operator())
      .def(
          "__sub__", [](const Field& a, const Field& b) { return combine(Csg::difference, a, b); }, py::is_operator());
  type.def(
          "translate", [](const Field& field, const py::object& by) { return translate(field, vector_of(by, "translate")); }, py::arg("by"),
          "Moved by a vector (3,), world units.")
      .def(
          "rotate",
          [](const Field& field, const py::object& axis, double degrees) {
            return rotate(field, vector_of(axis, "rotate"), degrees * std::numbers::pi / 180.0);
          },
          py::arg("axis"), py::arg("degrees"), "Turned about an axis (3,) through the origin, right-handed.")
      .def("scale", scaled, py::arg("factor"), "Scaled about the origin by a number, or by one for each axis (3,); negative ones mirror.")
      .def(
          "offset", [](const Field& field, double distance) { return offset(field, distance); }, py::arg("distance"),
          "Grown by a distance, world units; shrunk where it is negative.")
      .def(
          "shell", [](const Field& field, double thickness) { return shell(field, thickness); }, py::arg("thickness"),
          "A wall of that thickness, world units, about the surface.");
}

}  // namespace

void bind_fields(py::module_& module) {
  py::class_<Field> type(module, "Field", "An implicit surface: negative inside, zero on the surface, positive outside. Never changes.");
  add_operations(type);
  type.def("values", values_at, py::arg("points"), "The field at points (n, 3), world units: (n,).")
      .def("gradients", gradients_at, py::arg("points"), "Its gradient at points (n, 3): (n, 3).")
      .def_property_readonly(
          "bounds", [](const Field& field) { return array_of(field.traits().bounds); },
          "A box that holds the surface, world units: (2, 3), lower and upper corner.")
      .def("__repr__",
           [](const Field& field) {
             const Box box = field.traits().bounds;
             return fmt::format("<limn.Field from {:.3g}, {:.3g}, {:.3g} to {:.3g}, {:.3g}, {:.3g}>", box.lower.x, box.lower.y, box.lower.z,
                                box.upper.x, box.upper.y, box.upper.z);
           })
      .def_property_readonly(
          "lipschitz", [](const Field& field) { return field.traits().lipschitz; }, "No slope of the field is steeper than this.")
      .def_property_readonly(
          "exact_distance", [](const Field& field) { return field.traits().exact_distance; },
          "True where the field is the distance to its surface.");
  module.def("shape", shape_of, py::arg("name"), py::arg("parameters"));
  module.def("field_of", field_of, py::arg("function"), py::arg("bounds"), py::arg("lipschitz"), py::arg("gradient") = py::none(),
             py::arg("vectorized") = false);
  module.def("grid_of", grid_of, py::arg("values"), py::arg("origin"), py::arg("spacing"));
  module.def("formula_of", formula_of, py::arg("text"), py::arg("name"));
}

}  // namespace limn::python
