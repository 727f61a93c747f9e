// Level sets from fields, meshes, arrays and files, and back to arrays.

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <tuple>

#include "raymarch/scene.h"
#include "samples/python/arrays.h"
#include "samples/python/bindings.h"
#include "sdf/error.h"
#include "sdf/level_set_data.h"
#include "subdiv/mesh_level_set.h"

namespace limn::python {
namespace {

namespace py = pybind11;

/// OpenVDB's coordinates go far beyond; numbers of bytes do not.
constexpr std::int32_t kFarthest = 1 << 28;

double length_of(double value, const char* field) {
  if (!(value > 0.0) || !std::isfinite(value)) throw InputError({"", field, fmt::format("{}", value), "is no length", "a number above 0"});
  return value;
}

double half_width_of(double value) {
  if (!(value >= 1.8) || !(value <= 1e6))
    throw InputError({"", "half_width", fmt::format("{}", value), "out of range", "at least 1.8 voxels"});
  return value;
}

/// Collects voxels into blocks.
class Blocks {
 public:
  explicit Blocks(float background) : background_(background) {}

  /// `active`: the value is a distance; otherwise only its sign counts.
  void put(const glm::ivec3& at, float value, bool active) {
    const glm::ivec3 origin = at & ~7;
    if (blocks_.empty() || blocks_[last_].origin != origin) {
      const auto found = index_.try_emplace({origin.x, origin.y, origin.z}, blocks_.size());
      if (found.second) add(origin);
      last_ = found.first->second;
    }
    LevelSetBlock& block = blocks_[last_];
    const glm::ivec3 local = at - origin;
    const auto bit = static_cast<unsigned>(local.y * 8 + local.z);
    block.values[static_cast<size_t>(local.x * 64) + bit] = active ? value : std::copysign(background_, value);
    if (active) block.active[local.x] |= std::uint64_t{1} << bit;
  }
  std::span<const LevelSetBlock> all() const { return blocks_; }

 private:
  void add(const glm::ivec3& origin) {
    LevelSetBlock& block = blocks_.emplace_back();
    block.origin = origin;
    std::fill(std::begin(block.active), std::end(block.active), 0);
    std::fill(std::begin(block.values), std::end(block.values), background_);
  }

  float background_;
  std::map<std::tuple<int, int, int>, size_t> index_{};
  std::vector<LevelSetBlock> blocks_{};
  size_t last_ = 0;  ///< Neighbours are mostly in one block.
};

/// Samples of an array (nx, ny, nz), and where they stand.
struct Dense {
  const double* values;
  glm::ivec3 count{0};
  double voxel_size = 1.0, half_width = 3.0;

  double at(int i, int j, int k) const {
    return values[(static_cast<size_t>(i) * static_cast<size_t>(count.y) + static_cast<size_t>(j)) * static_cast<size_t>(count.z) +
                  static_cast<size_t>(k)];
  }
};

LevelSet level_set_of(const Dense& dense, const glm::dvec3& origin) {
  const double background = dense.half_width * dense.voxel_size;
  Blocks blocks(static_cast<float>(background));
  for (int i = 0; i < dense.count.x; ++i)
    for (int j = 0; j < dense.count.y; ++j)
      for (int k = 0; k < dense.count.z; ++k) {
        const double value = dense.at(i, j, k);
        const bool face = i == 0 || j == 0 || k == 0 || i == dense.count.x - 1 || j == dense.count.y - 1 || k == dense.count.z - 1;
        if (face && !(value > 0.0))
          throw InputError({"", "values", fmt::format("{}", value),
                            fmt::format("the surface reaches the array's faces, at index ({}, {}, {})", i, j, k),
                            "an array that goes on until all values are above 0"});
        if (std::fabs(value) < background) blocks.put({i, j, k}, static_cast<float>(value), true);
      }
  // Beside a surface that jumps over the band a node inside has no neighbour that tells its sign.
  for (int i = 0; i < dense.count.x; ++i)
    for (int j = 0; j < dense.count.y; ++j)
      for (int k = 0; k < dense.count.z; ++k)
        if (dense.at(i, j, k) <= -background) blocks.put({i, j, k}, -1.0f, false);
  return level_set_from_blocks(blocks.all(), dense.voxel_size, dense.half_width, "level_set", origin);
}

LevelSet from_array(const py::object& values, double voxel_size, const py::object& origin, double half_width) {
  const py::array_t<double> numbers = numbers_of(values, "values", {-1, -1, -1});
  const Dense dense{numbers.data(),
                    {numbers.shape(0), numbers.shape(1), numbers.shape(2)},
                    length_of(voxel_size, "voxel_size"),
                    half_width_of(half_width)};
  const glm::dvec3 at = vector_of(origin, "origin");
  return call_unlocked([&](const Stopped&) { return level_set_of(dense, at); });
}

LevelSet from_voxels(const py::object& indices, const py::object& values, double voxel_size, const py::object& origin,
                     const std::optional<double>& half_width) {
  const py::array_t<std::int32_t> places = whole_numbers_of(indices, "indices", {-1, 3});
  const py::array_t<double> numbers = numbers_of(values, "values", {static_cast<int>(places.shape(0))});
  const double size = length_of(voxel_size, "voxel_size");
  double most = 0.0;
  for (py::ssize_t i = 0; i < numbers.size(); ++i) most = std::max(most, std::fabs(numbers.data()[i]));
  const double width = half_width_of(half_width.value_or(std::max(1.8, most / size)));
  const glm::dvec3 at = vector_of(origin, "origin");
  for (py::ssize_t i = 0; i < places.size(); ++i)
    if (std::abs(std::int64_t{places.data()[i]}) > kFarthest)
      throw InputError({"", "indices", std::to_string(places.data()[i]), "out of range", fmt::format("at most {} either way", kFarthest)});
  return call_unlocked([&](const Stopped&) {
    Blocks blocks(static_cast<float>(width * size));
    for (py::ssize_t i = 0; i < numbers.size(); ++i) {
      const std::int32_t* const place = places.data() + 3 * i;
      blocks.put({place[0], place[1], place[2]}, static_cast<float>(numbers.data()[i]), true);
    }
    return level_set_from_blocks(blocks.all(), size, width, "level_set", at);
  });
}

py::tuple active_voxels(const LevelSet& level_set) {
  const auto& tree = level_set.data().grid->tree();
  const auto count = static_cast<py::ssize_t>(tree.activeVoxelCount());
  py::array_t<std::int32_t> indices({count, py::ssize_t{3}});
  py::array_t<float> values(count);
  py::ssize_t next = 0;
  const auto leaves = tree.nodeCount(0);
  const auto* const first = tree.getFirstNode<0>();
  for (std::uint32_t leaf = 0; leaf < leaves; ++leaf) {
    for (std::uint32_t n = 0; n < 512; ++n) {
      if (!first[leaf].isActive(n) || next >= count) continue;
      const nanovdb::Coord at = first[leaf].offsetToGlobalCoord(n);
      for (int axis = 0; axis < 3; ++axis) indices.mutable_at(next, axis) = at[static_cast<std::uint32_t>(axis)];
      values.mutable_at(next++) = first[leaf].getValue(n);
    }
  }
  return py::make_tuple(indices, values);
}

/// All nodes of the box around the active ones, one more on each side; and the index of the first.
py::tuple dense_values(const LevelSet& level_set, int margin) {
  if (margin < 0 || margin > 1024) throw InputError({"", "margin", std::to_string(margin), "out of range", "0 to 1024 voxels"});
  const auto box = level_set.data().grid->indexBBox();
  const nanovdb::Coord first = box.min().offsetBy(-margin), last = box.max().offsetBy(margin);
  const auto side = [&](std::uint32_t axis) { return py::ssize_t{last[axis]} - first[axis] + 1; };
  py::array_t<float> values({side(0), side(1), side(2)});
  float* out = values.mutable_data();
  run_unlocked([&](const Stopped& stopped) {
    const auto accessor = level_set.data().accessor();
    for (int i = first[0]; i <= last[0]; ++i) {
      if (stopped()) throw Cancelled{};
      for (int j = first[1]; j <= last[1]; ++j)
        for (int k = first[2]; k <= last[2]; ++k) *out++ = accessor.getValue(nanovdb::Coord(i, j, k));
    }
  });
  return py::make_tuple(values, py::make_tuple(first[0], first[1], first[2]));
}

py::array_t<double> matrix_of(const Affine& affine) {
  py::array_t<double> matrix({4, 4});
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) {
      const double identity = row == column ? 1.0 : 0.0;
      matrix.mutable_at(row, column) = row == 3 ? identity : column == 3 ? affine.translation[row] : affine.linear[column][row];
    }
  return matrix;
}

/// The side of a voxel: given, or from their number along the longest side.
double voxel_side(const Box& box, const std::optional<int>& voxels, const std::optional<double>& voxel_size) {
  if (voxels && voxel_size) throw InputError({"", "voxel_size", "", "cannot be given together with voxels", "one of the two"});
  if (voxel_size) return length_of(*voxel_size, "voxel_size");
  const int count = voxels.value_or(256);
  if (count < 4 || count > 8192) throw InputError({"", "voxels", std::to_string(count), "out of range", "a whole number from 4 to 8192"});
  if (!box.finite()) throw InputError({"", "voxels", "", "the surface has no end to count voxels along", "voxel_size"});
  return box.longest_side() / count;
}

LevelSet of_field(const Field& field, const std::optional<int>& voxels, const std::optional<double>& voxel_size, double half_width) {
  LevelSetSettings settings{.voxel_size = voxel_side(field.traits().bounds, voxels, voxel_size),
                            .half_width_voxels = half_width_of(half_width)};
  return call_unlocked([&](const Stopped& stopped) {
    settings.progress = stop_at_progress(stopped);
    return level_set_from_field(field, settings);
  });
}

LevelSet of_mesh(const SharedMesh& mesh, const std::optional<int>& voxels, const std::optional<double>& voxel_size, double half_width) {
  LevelSetSettings settings{.voxel_size = voxel_side(bounds(*mesh), voxels, voxel_size), .half_width_voxels = half_width_of(half_width)};
  return call_unlocked([&](const Stopped& stopped) {
    settings.progress = stop_at_progress(stopped);
    return level_set_from_mesh(triangulate(mesh, NormalKind::flat), settings).level_set;
  });
}

SharedMesh meshed(const LevelSet& level_set) {
  return call_unlocked([&](const Stopped&) {
    PolygonSoup soup = mesh_from_level_set(level_set);
    Mesh mesh;
    mesh.positions = std::move(soup.positions);
    mesh.face_sizes = std::move(soup.face_sizes);
    mesh.corner_vertices = std::move(soup.corner_vertices);
    return SharedMesh(std::move(mesh));
  });
}

py::array_t<double> values_at(const LevelSet& level_set, const py::object& points) {
  const std::vector<glm::dvec3> at = points_of_array(points, "points");
  py::array_t<double> values(static_cast<py::ssize_t>(at.size()));
  const std::span<double> out(values.mutable_data(), at.size());
  run_unlocked([&](const Stopped&) { level_set_values(level_set, at, out); });
  return values;
}

}  // namespace

void bind_level_sets(py::module_& module) {
  py::class_<LevelSet>(module, "LevelSet", "A narrow band of distances on a grid. Never changes.")
      .def("__repr__",
           [](const LevelSet& self) {
             return fmt::format("<limn.LevelSet: {} active voxels of {:.4g}>", self.info().active_voxels, self.info().voxel_size);
           })
      .def_property_readonly(
          "name", [](const LevelSet& self) { return self.info().name; }, "Of the grid in its file.")
      .def_property_readonly(
          "voxel_size", [](const LevelSet& self) { return self.info().voxel_size; }, "World units.")
      .def_property_readonly(
          "half_width", [](const LevelSet& self) { return self.info().half_width_voxels; }, "Of the band, voxels.")
      .def_property_readonly(
          "active_voxel_count", [](const LevelSet& self) { return self.info().active_voxels; }, "Nodes of the band.")
      .def_property_readonly(
          "bytes", [](const LevelSet& self) { return self.info().bytes; }, "Memory that the grid takes.")
      .def_property_readonly(
          "bounds", [](const LevelSet& self) { return array_of(self.info().bounds); }, "Of the surface, world units: (2, 3).")
      .def_property_readonly(
          "warnings", [](const LevelSet& self) { return self.info().warnings; }, "What a person should know before trusting it.")
      .def_property_readonly(
          "world_from_index", [](const LevelSet& self) { return matrix_of(self.info().world_from_index); },
          "Where the node (i, j, k, 1) stands: (4, 4).")
      .def("active", active_voxels, "Indices (n, 3) int32 and values (n,) float32, world units, of the band's nodes. Copies.")
      .def("dense", dense_values, py::arg("margin") = 1)
      .def("values", values_at, py::arg("points"), "Trilinear values at points (n, 3), world units: (n,).")
      .def("mesh", meshed, "The surface as quads and triangles, by dual contouring.")
      .def(
          "write",
          [](const LevelSet& self, const std::filesystem::path& file) {
            run_unlocked([&](const Stopped&) { write_level_set(self, file); });
          },
          py::arg("file"), "As .vdb, 32 bits.");
  module.def("level_set_from_array", from_array);
  module.def("level_set_from_voxels", from_voxels);
  module.def("level_set_of_field", of_field);
  module.def("level_set_of_mesh", of_mesh);
  module.def("read_level_set", [](const std::string& file, const std::string& grid) {
    return call_unlocked([&](const Stopped&) { return read_level_set(file, grid); });
  });
}

}  // namespace limn::python
