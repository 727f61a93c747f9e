#include "subdiv/gltf/materials.h"

#include <fmt/format.h>

namespace limn::gltf {
namespace {

/// The color of the metallic-roughness model, else that of the older one, else white. What has a wrong type counts as absent.
glm::vec3 base_color(const Json& material) {
  if (const Json* pbr = find_object(material, "pbrMetallicRoughness")) {
    if (const auto color = gltf::color(*pbr, "baseColorFactor")) return *color;
  }
  const Json* extensions = find_object(material, "extensions");
  const Json* older = extensions ? find_object(*extensions, "KHR_materials_pbrSpecularGlossiness") : nullptr;
  if (older) {
    if (const auto color = gltf::color(*older, "diffuseFactor")) return *color;
  }
  return glm::vec3(1.0f);
}

bool has_texture(const Json& material) {
  const Json* pbr = find_object(material, "pbrMetallicRoughness");
  if (pbr && find_object(*pbr, "baseColorTexture")) return true;
  const Json* extensions = find_object(material, "extensions");
  const Json* older = extensions ? find_object(*extensions, "KHR_materials_pbrSpecularGlossiness") : nullptr;
  return older && find_object(*older, "diffuseTexture");
}

}  // namespace

Materials read_materials(const Json& root) {
  Materials all;
  for (size_t i = 0; i < length(root, "materials"); ++i) {
    const Json& material = *find_element(root, "materials", i);
    const std::string name = text(material, "name");
    all.names.push_back(name.empty() ? fmt::format("material {}", i) : name);
    all.colors.push_back(base_color(material));
    all.textured.push_back(has_texture(material));
  }
  all.names.emplace_back("no material");
  all.colors.emplace_back(1.0f);
  all.textured.push_back(0);
  return all;
}

}  // namespace limn::gltf
