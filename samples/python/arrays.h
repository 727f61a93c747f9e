#pragma once
// numpy arrays in and out: pictures and lists of points as views of limn's own memory, arguments checked before limn sees them.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "sdf/geometry.h"
#include "sdf/image.h"

namespace limn::python {

/// The array can only be read: others may look at the same memory.
pybind11::array read_only(pybind11::array array);

/// How the pixels of a picture are seen: their numbers, and how many of them.
template <class T>
struct PixelOf {
  using Number = T;
  static constexpr pybind11::ssize_t channels = 0;
};
template <int count, class T>
struct PixelOf<glm::vec<count, T>> {
  using Number = T;
  static constexpr pybind11::ssize_t channels = count;
};

/// A picture as an array (height, width) or (height, width, channels) that looks at its pixels; `owner` keeps them. None where it is empty.
template <class T>
pybind11::object view_of(const Image<T>& image, const pybind11::handle& owner) {
  using Pixel = PixelOf<T>;
  if (image.pixels.empty()) return pybind11::none();
  const auto size = static_cast<pybind11::ssize_t>(sizeof(T)), width = static_cast<pybind11::ssize_t>(image.width);
  std::vector<pybind11::ssize_t> shape = {image.height, width}, strides = {width * size, size};
  if (Pixel::channels > 0) {
    shape.push_back(Pixel::channels);
    strides.push_back(static_cast<pybind11::ssize_t>(sizeof(typename Pixel::Number)));
  }
  return read_only(pybind11::array(pybind11::dtype::of<typename Pixel::Number>(), shape, strides, image.pixels.data(), owner));
}

/// A list of numbers or vectors as an array (n,) or (n, components) that looks at it.
template <class T>
pybind11::array view_of(const std::vector<T>& values, const pybind11::handle& owner) {
  using Pixel = PixelOf<T>;
  std::vector<pybind11::ssize_t> shape = {static_cast<pybind11::ssize_t>(values.size())};
  std::vector<pybind11::ssize_t> strides = {static_cast<pybind11::ssize_t>(sizeof(T))};
  if (Pixel::channels > 0) {
    shape.push_back(Pixel::channels);
    strides.push_back(static_cast<pybind11::ssize_t>(sizeof(typename Pixel::Number)));
  }
  return read_only(pybind11::array(pybind11::dtype::of<typename Pixel::Number>(), shape, strides, values.data(), owner));
}

/// One member of all structs of a list, as an array that looks at them.
template <class Struct, class T>
pybind11::array view_of(const std::vector<Struct>& list, T Struct::*member, const pybind11::handle& owner) {
  using Pixel = PixelOf<T>;
  const T* const first = list.empty() ? nullptr : &(list.front().*member);
  std::vector<pybind11::ssize_t> shape = {static_cast<pybind11::ssize_t>(list.size())};
  std::vector<pybind11::ssize_t> strides = {static_cast<pybind11::ssize_t>(sizeof(Struct))};
  if (Pixel::channels > 0) {
    shape.push_back(Pixel::channels);
    strides.push_back(static_cast<pybind11::ssize_t>(sizeof(typename Pixel::Number)));
  }
  return read_only(pybind11::array(pybind11::dtype::of<typename Pixel::Number>(), shape, strides, first, owner));
}

/// An argument as doubles, row by row. `shape`: -1 for any size. Throws InputError naming `field` for what is no array of numbers, another
/// shape, and, unless `finite` is false, for NaN and infinity.
pybind11::array_t<double> numbers_of(const pybind11::object& value, const std::string& field, const std::vector<int>& shape,
                                     bool finite = true);
/// The same for whole numbers that 32 bits hold; floating point is refused.
pybind11::array_t<std::int32_t> whole_numbers_of(const pybind11::object& value, const std::string& field, const std::vector<int>& shape);

/// A vector of three.
glm::dvec3 vector_of(const pybind11::object& value, const std::string& field);
/// Points (n, 3), copied.
std::vector<glm::dvec3> points_of_array(const pybind11::object& value, const std::string& field);
/// A box as two corners, (2, 3).
Box box_of(const pybind11::object& value, const std::string& field);
/// The same out: (2, 3).
pybind11::array_t<double> array_of(const Box& box);

}  // namespace limn::python
