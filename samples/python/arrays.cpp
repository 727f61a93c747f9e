#include "samples/python/arrays.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "sdf/error.h"

namespace limn::python {
namespace {

namespace py = pybind11;

std::string shape_text(const std::vector<int>& shape) {
  std::string text;
  for (const int size : shape) text += (text.empty() ? "" : ", ") + (size < 0 ? std::string("n") : std::to_string(size));
  return "(" + text + (shape.size() == 1 ? ",)" : ")");
}

std::string shape_text(const py::array& array) {
  std::vector<int> shape;
  for (py::ssize_t i = 0; i < array.ndim(); ++i) shape.push_back(static_cast<int>(array.shape(i)));
  return shape_text(shape);
}

/// Whatever numpy makes an array of: lists and other libraries' arrays, too.
py::array array_from(const py::object& value, const std::string& field, const std::string& kinds, const std::string& expected) {
  py::array array;
  try {
    array = py::module_::import("numpy").attr("asarray")(value);
  } catch (const py::error_already_set& error) {
    if (!error.matches(PyExc_ValueError) && !error.matches(PyExc_TypeError)) throw;
    throw InputError({"", field, "", "is no array", expected});
  }
  if (kinds.find(array.dtype().kind()) == std::string::npos)
    throw InputError({"", field, py::str(array.dtype()).cast<std::string>(), "holds no numbers of this kind", expected});
  return array;
}

void check_shape(const py::array& array, const std::string& field, const std::vector<int>& shape) {
  bool same = array.ndim() == static_cast<py::ssize_t>(shape.size());
  for (size_t i = 0; same && i < shape.size(); ++i) same = shape[i] < 0 || array.shape(static_cast<py::ssize_t>(i)) == shape[i];
  if (!same) throw InputError({"", field, shape_text(array), "has the wrong shape", "an array of shape " + shape_text(shape)});
}

}  // namespace

py::array read_only(py::array array) {
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

py::array_t<double> numbers_of(const py::object& value, const std::string& field, const std::vector<int>& shape, bool finite) {
  const std::string expected = "an array of real numbers of shape " + shape_text(shape);
  const py::array array = array_from(value, field, "fiu", expected);
  check_shape(array, field, shape);
  py::array_t<double> numbers = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!numbers) {
    PyErr_Clear();
    throw InputError({"", field, "", "cannot be read as 64-bit numbers", expected});
  }
  const double* const data = numbers.data();
  for (py::ssize_t i = 0; finite && i < numbers.size(); ++i)
    if (!std::isfinite(data[i])) throw InputError({"", field, fmt::format("{}", data[i]), "is not finite", "finite numbers"});
  return numbers;
}

py::array_t<std::int32_t> whole_numbers_of(const py::object& value, const std::string& field, const std::vector<int>& shape) {
  const std::string expected = "an array of whole numbers of shape " + shape_text(shape);
  const py::array array = array_from(value, field, "iu", expected);
  check_shape(array, field, shape);
  const auto wide = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!wide) {
    PyErr_Clear();
    throw InputError({"", field, "", "cannot be read as whole numbers", expected});
  }
  py::array_t<std::int32_t> numbers(std::vector<py::ssize_t>(array.shape(), array.shape() + array.ndim()));
  for (py::ssize_t i = 0; i < wide.size(); ++i) {
    const std::int64_t number = wide.data()[i];
    if (number < std::numeric_limits<std::int32_t>::min() || number > std::numeric_limits<std::int32_t>::max())
      throw InputError({"", field, std::to_string(number), "is out of range", "whole numbers of 32 bits"});
    numbers.mutable_data()[i] = static_cast<std::int32_t>(number);
  }
  return numbers;
}

glm::dvec3 vector_of(const py::object& value, const std::string& field) {
  const py::array_t<double> numbers = numbers_of(value, field, {3});
  return {numbers.data()[0], numbers.data()[1], numbers.data()[2]};
}

std::vector<glm::dvec3> points_of_array(const py::object& value, const std::string& field) {
  const py::array_t<double> numbers = numbers_of(value, field, {-1, 3});
  std::vector<glm::dvec3> points(static_cast<size_t>(numbers.shape(0)));
  const double* const data = numbers.data();
  for (size_t i = 0; i < points.size(); ++i) points[i] = {data[3 * i], data[3 * i + 1], data[3 * i + 2]};
  return points;
}

Box box_of(const py::object& value, const std::string& field) {
  const py::array_t<double> numbers = numbers_of(value, field, {2, 3});
  const double* const data = numbers.data();
  const Box box{{data[0], data[1], data[2]}, {data[3], data[4], data[5]}};
  if (box.empty()) throw InputError({"", field, "", "is an empty box", "the lower corner, then the upper one"});
  return box;
}

py::array_t<double> array_of(const Box& box) {
  py::array_t<double> array({2, 3});
  for (int i = 0; i < 3; ++i) {
    array.mutable_at(0, i) = box.lower[i];
    array.mutable_at(1, i) = box.upper[i];
  }
  return array;
}

}  // namespace limn::python
