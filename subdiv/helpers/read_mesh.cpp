// limn-read-mesh FILE MAX_ELEMENTS: reads a .gltf or .glb that nobody vouches for with assimp, and answers with a
// flat mesh (sdf/guard.h).
#include <assimp/BaseImporter.h>
#include <assimp/DefaultIOSystem.h>
#include <assimp/importerdesc.h>
#include <assimp/scene.h>
#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>

#include "sdf/guard_helper.h"
#include "subdiv/mesh_bytes.h"
#include "subdiv/read_gltf.h"

namespace {

namespace fs = std::filesystem;
using limn::Mesh;

[[noreturn]] void refuse(const std::string& reason) { throw std::runtime_error(reason); }

/// glTF names files of its own; only those in its folder or below are opened.
class OwnFolderOnly : public Assimp::DefaultIOSystem {
 public:
  explicit OwnFolderOnly(const fs::path& file) : folder_(fs::weakly_canonical(file).parent_path()) {}
  bool Exists(const char* name) const override { return allowed(name) && DefaultIOSystem::Exists(name); }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    return allowed(name) ? DefaultIOSystem::Open(name, mode) : nullptr;
  }

 private:
  bool allowed(const char* name) const {
    std::error_code error;
    const fs::path relative = fs::weakly_canonical(name, error).lexically_relative(folder_);
    // A pipe would be waited for.
    return !error && !relative.empty() && *relative.begin() != ".." && fs::is_regular_file(name, error);
  }
  fs::path folder_;
};

/// assimp drops faces whose indices are out of range and says so in its log only.
class Complaints : public Assimp::LogStream {
 public:
  explicit Complaints(std::string& found) : found_(found) {}
  void write(const char* message) override {
    const std::string text(message);
    if (text.find("out-of-range") != std::string::npos || text.find("out of range") != std::string::npos) found_ = text;
  }

 private:
  std::string& found_;
};

/// Only the reader of the file's own format stays: a file is what its extension says or it is refused.
void keep_readers(Assimp::Importer& importer, const std::string& extension) {
  std::vector<Assimp::BaseImporter*> others;
  for (size_t i = 0; i < importer.GetImporterCount(); ++i) {
    const aiImporterDesc* about = importer.GetImporterInfo(i);
    const std::string list = std::string(" ") + (about != nullptr ? about->mFileExtensions : "") + " ";
    if (list.find(" " + extension + " ") == std::string::npos) others.push_back(importer.GetImporter(i));
  }
  for (Assimp::BaseImporter* other : others) {
    importer.UnregisterLoader(other);
    delete other;  // an unregistered reader belongs to whoever took it out
  }
}

/// Gathers the parts of a scene into one mesh.
class Gatherer {
 public:
  Gatherer(const aiScene& scene, std::int64_t max_elements) : scene_(scene), max_elements_(max_elements) {}

  Mesh run() {
    for (unsigned i = 0; i < scene_.mNumMaterials; ++i) {
      aiString name;
      scene_.mMaterials[i]->Get(AI_MATKEY_NAME, name);
      mesh_.material_names.emplace_back(name.C_Str());
    }
    for (unsigned i = 0; i < scene_.mNumMeshes; ++i) {
      any_normals_ &= scene_.mMeshes[i]->HasNormals();
      any_colors_ |= scene_.mMeshes[i]->HasVertexColors(0);
    }
    node(*scene_.mRootNode, aiMatrix4x4(), 0);
    if (mesh_.material_names.size() < 2) mesh_.material_names.clear(), mesh_.face_materials.clear();
    if (mesh_.group_names.size() < 2) mesh_.group_names.clear(), mesh_.face_groups.clear();
    if (mesh_.face_sizes.empty()) refuse("the mesh has no faces; at least one face with 3 or more corners");
    return std::move(mesh_);
  }

 private:
  void node(const aiNode& node_, const aiMatrix4x4& world_from_parent, int depth) {
    if (depth > 200) refuse("parts are nested more than 200 deep; a tree of parts without loops");
    const aiMatrix4x4 world_from_node = world_from_parent * node_.mTransformation;
    for (unsigned i = 0; i < node_.mNumMeshes; ++i) {
      if (node_.mMeshes[i] >= scene_.mNumMeshes) refuse("a part names a mesh that is not there");
      part(*scene_.mMeshes[node_.mMeshes[i]], world_from_node, node_.mName.C_Str());
    }
    for (unsigned i = 0; i < node_.mNumChildren; ++i) node(*node_.mChildren[i], world_from_node, depth + 1);
  }

  void part(const aiMesh& source, const aiMatrix4x4& world_from_node, const std::string& name) {
    // Points and lines beside the faces have no surface.
    bool any_face = false;
    for (unsigned f = 0; f < source.mNumFaces; ++f) any_face |= source.mFaces[f].mNumIndices >= 3;
    if (!any_face) return;
    const aiMatrix3x3 linear(world_from_node);
    const bool mirrored = linear.Determinant() < 0.0f;
    aiMatrix3x3 normal_matrix(linear);
    normal_matrix.Inverse().Transpose();
    const size_t base = mesh_.positions.size();
    vertices(source, world_from_node);
    const auto group = static_cast<std::int32_t>(mesh_.group_names.size());
    mesh_.group_names.push_back(name.empty() ? source.mName.C_Str() : name);
    for (unsigned f = 0; f < source.mNumFaces; ++f) {
      const aiFace& face = source.mFaces[f];
      if (face.mNumIndices < 3) continue;
      count(face.mNumIndices);
      mesh_.face_sizes.push_back(static_cast<std::int32_t>(face.mNumIndices));
      mesh_.face_materials.push_back(static_cast<std::int32_t>(source.mMaterialIndex));
      mesh_.face_groups.push_back(group);
      for (unsigned i = 0; i < face.mNumIndices; ++i) {
        // A mirrored part would be turned inside out.
        const unsigned index = face.mIndices[mirrored ? face.mNumIndices - 1 - i : i];
        if (index >= source.mNumVertices)
          refuse("face " + std::to_string(f + 1) + " names vertex " + std::to_string(index) + ", which is out of range; there are " +
                 std::to_string(source.mNumVertices));
        mesh_.corner_vertices.push_back(static_cast<std::int32_t>(base + index));
        if (any_normals_) mesh_.corner_normals.push_back(finite(normal_matrix * source.mNormals[index]));
      }
    }
  }

  static glm::vec3 finite(const aiVector3D& v) {
    const glm::vec3 n(v.x, v.y, v.z);
    const float length = glm::length(n);
    return length > 0.0f && std::isfinite(length) ? n / length : glm::vec3(0.0f);
  }

  void vertices(const aiMesh& source, const aiMatrix4x4& m) {
    count(source.mNumVertices);
    for (unsigned v = 0; v < source.mNumVertices; ++v) {
      // In double: the file's float is exact, and an identity leaves it so.
      const glm::dvec3 p(source.mVertices[v].x, source.mVertices[v].y, source.mVertices[v].z);
      mesh_.positions.emplace_back(m.a1 * p.x + m.a2 * p.y + m.a3 * p.z + m.a4, m.b1 * p.x + m.b2 * p.y + m.b3 * p.z + m.b4,
                                   m.c1 * p.x + m.c2 * p.y + m.c3 * p.z + m.c4);
      if (!any_colors_) continue;
      glm::vec3 color(1.0f);
      if (source.HasVertexColors(0)) color = {source.mColors[0][v].r, source.mColors[0][v].g, source.mColors[0][v].b};
      for (int i = 0; i < 3; ++i) color[i] = std::isfinite(color[i]) ? std::clamp(color[i], 0.0f, 1.0f) : 1.0f;
      mesh_.vertex_colors.push_back(color);
    }
  }

  void count(std::int64_t more) {
    elements_ += more;
    if (elements_ > max_elements_) refuse("more vertices and corners than allowed; at most " + std::to_string(max_elements_));
  }

  const aiScene& scene_;
  std::int64_t max_elements_, elements_ = 0;
  bool any_normals_ = true, any_colors_ = false;
  Mesh mesh_;
};

void read(const std::string& file, std::int64_t max_elements, limn::ByteWriter& answer) {
  std::string extension = fs::path(file).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (!extension.empty()) extension.erase(0, 1);
  if (extension == "gltf" || extension == "glb") {
    // Of glTF 1.0 nothing comes back; assimp reads that.
    if (std::optional<Mesh> mesh = limn::read_gltf(file, max_elements)) {
      limn::put_mesh(answer, std::move(*mesh));
      return;
    }
  }
  std::string complaint;
  Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
  Assimp::DefaultLogger::get()->attachStream(new Complaints(complaint), Assimp::Logger::Warn | Assimp::Logger::Err);
  Assimp::Importer importer;
  keep_readers(importer, extension);
  importer.SetIOHandler(new OwnFolderOnly(file));
  const aiScene* scene = importer.ReadFile(file, 0);
  if (scene == nullptr)
    refuse("damaged or not a ." + extension + " file: " + importer.GetErrorString() + "; an undamaged ." + extension +
           " file with all that it refers to beside it");
  if (!complaint.empty()) refuse("a face's index is out of range; indices below the number of vertices");
  if (scene->mRootNode == nullptr) refuse("the mesh has no faces; at least one face with 3 or more corners");
  limn::put_mesh(answer, Gatherer(*scene, max_elements).run());
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 3) {
    std::fputs("usage: limn-read-mesh FILE MAX_ELEMENTS (started by limn, answers on file descriptor 3)\n", stderr);
    return 2;
  }
  return limn::run_helper([&](limn::ByteWriter& answer) { read(arguments[1], std::atoll(arguments[2]), answer); });
}
