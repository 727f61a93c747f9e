#include "second_reader.h"

#include <CGAL/IO/polygon_soup_io.h>
#include <CGAL/Simple_cartesian.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <array>
#include <fstream>
#include <set>

namespace limn::foreign {
namespace {

using Point = CGAL::Simple_cartesian<double>::Point_3;

SecondReading read_by_cgal(const std::filesystem::path& file) {
  SecondReading result;
  result.reader = "CGAL";
  std::vector<Point> points;
  try {
    if (!CGAL::IO::read_polygon_soup(file.string(), points, result.soup.faces, CGAL::parameters::verbose(false)))
      result.refusal = "CGAL refuses it";
  } catch (const std::exception& error) {
    result.refusal = error.what();
  }
  for (const Point& p : points) result.soup.positions.emplace_back(p.x(), p.y(), p.z());
  for (const std::vector<size_t>& face : result.soup.faces)
    for (const size_t vertex : face)
      if (vertex >= points.size()) result.refusal = "an index out of range";
  return result;
}

void gather(const aiScene& scene, const aiNode& node, const aiMatrix4x4& world_from_parent, Soup& soup) {
  const aiMatrix4x4 world_from_node = world_from_parent * node.mTransformation;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    const aiMesh& mesh = *scene.mMeshes[node.mMeshes[i]];
    const size_t first = soup.positions.size();
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D p = world_from_node * mesh.mVertices[v];
      soup.positions.emplace_back(p.x, p.y, p.z);
    }
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      if (mesh.mFaces[f].mNumIndices < 3) continue;
      std::vector<size_t>& face = soup.faces.emplace_back();
      for (unsigned k = 0; k < mesh.mFaces[f].mNumIndices; ++k) face.push_back(first + mesh.mFaces[f].mIndices[k]);
    }
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) gather(scene, *node.mChildren[i], world_from_node, soup);
}

SecondReading read_by_assimp(const std::filesystem::path& file) {
  SecondReading result;
  result.reader = "assimp";
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(file.string(), 0);
  if (scene == nullptr || scene->mRootNode == nullptr)
    result.refusal = std::string("assimp: ") + importer.GetErrorString();
  else
    gather(*scene, *scene->mRootNode, aiMatrix4x4(), result.soup);
  return result;
}

glm::dvec3 vector_area(const Soup& soup, const std::vector<size_t>& face) {
  glm::dvec3 sum(0.0);
  for (size_t k = 2; k < face.size(); ++k)
    sum += glm::cross(soup.positions[face[k - 1]] - soup.positions[face[0]], soup.positions[face[k]] - soup.positions[face[0]]);
  return 0.5 * sum;
}

}  // namespace

void write_binary_off(const Soup& soup, const std::filesystem::path& file) {
  std::vector<Point> points;
  for (const glm::dvec3& p : soup.positions) points.emplace_back(p.x, p.y, p.z);
  std::ofstream stream(file, std::ios::binary);
  CGAL::IO::set_binary_mode(stream);
  CGAL::IO::write_OFF(stream, points, soup.faces);
}

SecondReading read_by_other(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  return extension == ".gltf" || extension == ".glb" ? read_by_assimp(file) : read_by_cgal(file);
}

Soup soup_of(const Mesh& mesh) {
  Soup soup{mesh.positions, {}};
  size_t corner = 0;
  for (const std::int32_t size : mesh.face_sizes) {
    std::vector<size_t>& face = soup.faces.emplace_back();
    for (std::int32_t k = 0; k < size; ++k) face.push_back(static_cast<size_t>(mesh.corner_vertices[corner++]));
  }
  return soup;
}

Measures measure(const Soup& soup) {
  Measures result;
  std::set<std::array<float, 3>> places;
  for (const std::vector<size_t>& face : soup.faces) {
    if (!(glm::length(vector_area(soup, face)) > 0.0)) continue;
    ++result.faces;
    result.area += glm::length(vector_area(soup, face));
    for (const size_t vertex : face) {
      const glm::dvec3& p = soup.positions[vertex];
      result.box = include(result.box, p);
      // In single precision, which is what one of the readers keeps.
      places.insert({static_cast<float>(p.x) + 0.0f, static_cast<float>(p.y) + 0.0f, static_cast<float>(p.z) + 0.0f});
    }
  }
  result.used_vertices = places.size();
  return result;
}

}  // namespace limn::foreign
