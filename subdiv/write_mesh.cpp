#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include "sdf/error.h"
#include "sdf/output_file.h"
#include "subdiv/import.h"
#include "subdiv/mesh_bytes.h"
#include "subdiv/polygon.h"

namespace limn {
namespace {

using Text = fmt::memory_buffer;

/// Output goes out in pieces, so that a large mesh is not in memory twice.
class Sink {
 public:
  explicit Sink(const std::filesystem::path& file) : stream_(file, std::ios::binary), file_(file) {}
  Text text;
  void spill(bool all = false) {
    if (!all && text.size() < (1u << 20)) return;
    stream_.write(text.data(), static_cast<std::streamsize>(text.size()));
    text.clear();
  }
  void close() {
    spill(true);
    stream_.close();
    if (!stream_) throw MachineError(fmt::format("{}: writing failed", file_.string()));
  }

 private:
  std::ofstream stream_;
  std::filesystem::path file_;
};

template <class... Arguments>
void print(Text& text, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Arguments>(arguments)...);
}

float shown(float linear) { return srgb_from_linear(std::clamp(linear, 0.0f, 1.0f)); }

/// A name as the rest of a line: line ends would begin statements, a backslash at the end would join the next line.
std::string in_line(std::string name) {
  for (char& c : name)
    if (static_cast<unsigned char>(c) < ' ') c = '_';
  if (name.ends_with('\\')) name.back() = '_';
  return name;
}

/// The shortest decimals that read back as the same number.
void write_obj(const Mesh& mesh, Sink& out) {
  print(out.text, "# written by limn: {} vertices, {} faces\n", mesh.vertex_count(), mesh.face_count());
  for (size_t v = 0; v < mesh.vertex_count(); ++v, out.spill()) {
    const glm::dvec3& p = mesh.positions[v];
    print(out.text, "v {} {} {}", p.x, p.y, p.z);
    if (!mesh.vertex_colors.empty()) {
      const glm::vec3& c = mesh.vertex_colors[v];
      print(out.text, " {} {} {}", shown(c.r), shown(c.g), shown(c.b));
    }
    print(out.text, "\n");
  }
  for (const glm::vec3& n : mesh.corner_normals) print(out.text, "vn {} {} {}\n", n.x, n.y, n.z), out.spill();
  std::int32_t material = -1, group = -1;
  size_t corner = 0;
  for (size_t f = 0; f < mesh.face_count(); ++f, out.spill()) {
    if (!mesh.face_groups.empty() && mesh.face_groups[f] != group) {
      group = mesh.face_groups[f];
      print(out.text, "g {}\n", in_line(mesh.group_names[static_cast<size_t>(group)]));
    }
    if (!mesh.face_materials.empty() && mesh.face_materials[f] != material) {
      material = mesh.face_materials[f];
      print(out.text, "usemtl {}\n", in_line(mesh.material_names[static_cast<size_t>(material)]));
    }
    if (!mesh.face_smoothing.empty() && (f == 0 || mesh.face_smoothing[f] != mesh.face_smoothing[f - 1]))
      print(out.text, "s {}\n", mesh.face_smoothing[f]);
    print(out.text, "f");
    for (std::int32_t i = 0; i < mesh.face_sizes[f]; ++i, ++corner) {
      print(out.text, " {}", mesh.corner_vertices[corner] + 1);
      if (!mesh.corner_normals.empty()) print(out.text, "//{}", corner + 1);
    }
    print(out.text, "\n");
  }
  for (const Crease& c : mesh.creases) print(out.text, "t crease 2/1/0 {} {} {}\n", c.vertex_a, c.vertex_b, c.sharpness), out.spill();
  for (const CornerTag& c : mesh.corners) print(out.text, "t corner 1/1/0 {} {}\n", c.vertex, c.sharpness), out.spill();
  const int rule = mesh.boundary == BoundaryRule::none ? 0 : mesh.boundary == BoundaryRule::edge_and_corner ? 1 : 2;
  print(out.text, "t interpolateboundary 1/0/0 {}\n", rule);
  if (mesh.crease_method == CreaseMethod::chaikin) print(out.text, "t creasemethod 0/0/1 chaikin\n");
  if (mesh.triangle_rule == TriangleRule::smooth) print(out.text, "t smoothtriangles 0/0/1 smooth\n");
  for (const std::int32_t hole : mesh.holes) print(out.text, "t hole 1/0/0 {}\n", hole), out.spill();
}

template <class T>
void put(Text& text, const T& value) {
  const char* bytes = reinterpret_cast<const char*>(&value);
  text.append(bytes, bytes + sizeof value);
}

/// PLY has normals by vertex only: they are written where all corners of each vertex agree.
std::vector<glm::vec3> common_normals(const Mesh& mesh) {
  if (mesh.corner_normals.empty()) return {};
  std::vector<glm::vec3> normals(mesh.vertex_count(), glm::vec3(0.0f));
  for (size_t c = 0; c < mesh.corner_vertices.size(); ++c) {
    glm::vec3& normal = normals[static_cast<size_t>(mesh.corner_vertices[c])];
    if (normal == glm::vec3(0.0f)) normal = mesh.corner_normals[c];
    if (glm::length(normal - mesh.corner_normals[c]) > 1e-5f) return {};
  }
  return normals;
}

void write_ply(const Mesh& mesh, Sink& out) {
  const std::vector<glm::vec3> normals = common_normals(mesh);
  const bool wide = std::any_of(mesh.face_sizes.begin(), mesh.face_sizes.end(), [](std::int32_t size) { return size > 255; });
  print(out.text, "ply\nformat binary_little_endian 1.0\ncomment written by limn\nelement vertex {}\n", mesh.vertex_count());
  print(out.text, "property double x\nproperty double y\nproperty double z\n");
  if (!normals.empty()) print(out.text, "property float nx\nproperty float ny\nproperty float nz\n");
  if (!mesh.vertex_colors.empty()) print(out.text, "property uchar red\nproperty uchar green\nproperty uchar blue\n");
  print(out.text, "element face {}\nproperty list {} int vertex_indices\nend_header\n", mesh.face_count(), wide ? "int" : "uchar");
  for (size_t v = 0; v < mesh.vertex_count(); ++v, out.spill()) {
    put(out.text, mesh.positions[v]);
    if (!normals.empty()) put(out.text, normals[v]);
    for (int i = 0; i < 3 && !mesh.vertex_colors.empty(); ++i)
      put(out.text, static_cast<unsigned char>(std::lround(255.0f * shown(mesh.vertex_colors[v][i]))));
  }
  size_t corner = 0;
  for (size_t f = 0; f < mesh.face_count(); ++f, out.spill()) {
    if (wide) {
      put(out.text, mesh.face_sizes[f]);
    } else {
      put(out.text, static_cast<unsigned char>(mesh.face_sizes[f]));
    }
    for (std::int32_t i = 0; i < mesh.face_sizes[f]; ++i, ++corner) put(out.text, mesh.corner_vertices[corner]);
  }
}

}  // namespace

void write_mesh(const Mesh& mesh, const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  const bool obj = extension == ".obj" || extension == ".OBJ", ply = extension == ".ply" || extension == ".PLY";
  if (!obj && !ply) throw InputError({file.string(), "", extension, "meshes are not written in this format", ".obj or .ply"});
  write_whole(file, [&](const std::filesystem::path& temporary) {
    Sink sink(temporary);
    if (obj) {
      write_obj(mesh, sink);
    } else {
      write_ply(mesh.holes.empty() ? mesh : without_holes(mesh), sink);
    }
    sink.close();
  });
}

}  // namespace limn
