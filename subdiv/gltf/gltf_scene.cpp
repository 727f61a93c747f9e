#include "subdiv/gltf/gltf_scene.h"

#include <fmt/format.h>

#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "subdiv/gltf/accessor.h"

namespace limn::gltf {
namespace {

glm::dmat4 from_parts(const glm::dvec3& translation, const glm::dquat& rotation, const glm::dvec3& scale) {
  const double length = glm::length(rotation);
  glm::dmat4 matrix = length > 0.0 && std::isfinite(length) ? glm::mat4_cast(rotation / length) : glm::dmat4(1.0);
  for (int i = 0; i < 3; ++i) matrix[i] *= scale[i];
  matrix[3] = glm::dvec4(translation, 1.0);
  return matrix;
}

glm::dmat4 placement(const Json& node, const std::string& where) {
  if (const std::vector<double> m = numbers(node, "matrix", 16, where); !m.empty()) {
    glm::dmat4 matrix;
    for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = m[static_cast<size_t>(i)];
    return matrix;
  }
  glm::dvec3 translation(0.0), scale(1.0);
  glm::dquat rotation(1.0, 0.0, 0.0, 0.0);
  if (const auto t = numbers(node, "translation", 3, where); !t.empty()) translation = {t[0], t[1], t[2]};
  if (const auto s = numbers(node, "scale", 3, where); !s.empty()) scale = {s[0], s[1], s[2]};
  if (const auto r = numbers(node, "rotation", 4, where); !r.empty()) rotation = glm::dquat(r[3], r[0], r[1], r[2]);
  return from_parts(translation, rotation, scale);
}

std::vector<std::uint64_t> indices_of(const Json& holder, const char* key, const std::string& where) {
  std::vector<std::uint64_t> all;
  const Json* list = find(holder, key);
  if (!list) return all;
  if (!list->is_array()) refuse(where + "." + key, "not a list", "a list of nodes");
  for (const Json& item : *list) {
    if (!item.is_number_unsigned()) refuse(where + "." + key, "not a node's number", "a whole number of 0 or more");
    all.push_back(item.get<std::uint64_t>());
  }
  return all;
}

std::vector<std::uint64_t> nodes_without_parent(const Json& root) {
  const size_t count = length(root, "nodes");
  std::vector<char> has_parent(count, 0);
  for (size_t i = 0; i < count; ++i) {
    for (const std::uint64_t child : indices_of(*find_element(root, "nodes", i), "children", element("nodes", i))) {
      if (child < count) has_parent[static_cast<size_t>(child)] = 1;
    }
  }
  std::vector<std::uint64_t> roots;
  for (size_t i = 0; i < count; ++i) {
    if (!has_parent[i]) roots.push_back(i);
  }
  if (roots.empty() && count > 0) refuse("nodes", "the nodes hold each other (recursive)", "a tree of nodes");
  return roots;
}

std::vector<std::uint64_t> root_nodes(Document& document) {
  const Json& root = document.root;
  const size_t scenes = length(root, "scenes");
  bool wrong = false;
  const auto chosen = lenient_number(root, "scene", wrong);
  if (scenes == 0) {
    if (chosen || wrong) document.warnings.emplace_back("the file has no scenes: all of its nodes are drawn");
    return nodes_without_parent(root);
  }
  if (wrong) document.warnings.emplace_back("the entry 'scene' is no number: the first scene is drawn");
  if (chosen && *chosen >= scenes)
    document.warnings.push_back(fmt::format("scene {} does not exist: the first of {} is drawn", *chosen, scenes));
  const std::uint64_t scene = chosen && *chosen < scenes ? *chosen : 0;
  if (!chosen && scenes > 1)
    document.warnings.push_back(fmt::format("the file does not say which of its {} scenes to draw: the first", scenes));
  return indices_of(*find_element(root, "scenes", scene), "nodes", element("scenes", scene));
}

bool visible(const Json& node) {
  const Json* extensions = find_object(node, "extensions");
  const Json* visibility = extensions ? find_object(*extensions, "KHR_node_visibility") : nullptr;
  const Json* flag = visibility ? find(*visibility, "visible") : nullptr;
  return !flag || !flag->is_boolean() || flag->get<bool>();
}

Elements instance_part(Document& document, const Json& attributes, const char* name, int components, const std::string& where) {
  const auto accessor = whole_number(attributes, name, where);
  if (!accessor) return {};
  Elements part = read_elements(document, *accessor, where + "." + name);
  if (part.components != components) refuse(where + "." + name, "of a wrong type", fmt::format("VEC{}", components));
  return part;
}

size_t instance_count(const Document& document, const Json& attributes, const std::string& where) {
  std::uint64_t count = 0;
  for (const auto& [name, accessor] : attributes.items())
    if (const auto index = whole_number(attributes, name.c_str(), where)) count = std::max(count, count_of(document, *index));
  if (count > static_cast<std::uint64_t>(document.max_elements))
    refuse(where + ".extensions", "more instances than allowed", fmt::format("at most {}", document.max_elements),
           fmt::format("{}", count));
  return static_cast<size_t>(count);
}

/// EXT_mesh_gpu_instancing: a list of places instead of the node's one.
std::vector<glm::dmat4> instances(Document& document, const Json& node, const std::string& where) {
  const Json* extensions = find_object(node, "extensions");
  const Json* instancing = extensions ? find_object(*extensions, "EXT_mesh_gpu_instancing") : nullptr;
  const Json* attributes = instancing ? find_object(*instancing, "attributes") : nullptr;
  if (!attributes) return {glm::dmat4(1.0)};
  const Elements t = instance_part(document, *attributes, "TRANSLATION", 3, where),
                 r = instance_part(document, *attributes, "ROTATION", 4, where),
                 s = instance_part(document, *attributes, "SCALE", 3, where);
  size_t count = std::max({t.count, r.count, s.count});
  // Attributes of somebody's own place nothing, and still say how many there are.
  if (count == 0 && !attributes->empty()) count = instance_count(document, *attributes, where);
  for (const Elements* part : {&t, &r, &s}) {
    if (part->count != 0 && part->count != count) refuse(where + ".extensions", "lists of instances of different lengths", "one length");
  }
  std::vector<glm::dmat4> all;
  for (size_t i = 0; i < count; ++i) {
    const double* q = r.count ? r.values.data() + 4 * i : nullptr;
    all.push_back(from_parts(t.count ? t.vec3(i) : glm::dvec3(0.0), q ? glm::dquat(q[3], q[0], q[1], q[2]) : glm::dquat(1.0, 0.0, 0.0, 0.0),
                             s.count ? s.vec3(i) : glm::dvec3(1.0)));
  }
  return all;
}

/// A step of the walk over the nodes: one is entered with its parent's placement, or left.
struct Step {
  std::uint64_t node = 0;
  glm::dmat4 world_from_parent{1.0};
  bool leave = false;
};

struct Walk {
  enum State : char { fresh, open, done };
  std::vector<State> states{};
  std::vector<Step> steps{};
  std::vector<PlacedMesh> placed{};
  std::int64_t hidden = 0, repeated = 0, missing = 0;
};

void enter(Document& document, const Step& step, Walk& walk) {
  const Json* node = find_element(document.root, "nodes", step.node);
  if (!node || !node->is_object()) {
    ++walk.missing;
    return;
  }
  Walk::State& state = walk.states[static_cast<size_t>(step.node)];
  const std::string where = element("nodes", step.node);
  if (state == Walk::open) refuse(where, "the node holds itself (recursive)", "a tree of nodes");
  if (state == Walk::done) {
    ++walk.repeated;
    return;
  }
  if (!visible(*node)) {
    ++walk.hidden;
    return;
  }
  state = Walk::open;
  const glm::dmat4 world_from_node = step.world_from_parent * placement(*node, where);
  if (const auto mesh = whole_number(*node, "mesh", where)) {
    for (const glm::dmat4& node_from_mesh : instances(document, *node, where))
      walk.placed.push_back({static_cast<size_t>(step.node), *mesh, world_from_node * node_from_mesh});
  }
  walk.steps.push_back({step.node, {}, true});
  const std::vector<std::uint64_t> children = indices_of(*node, "children", where);
  for (auto child = children.rbegin(); child != children.rend(); ++child) walk.steps.push_back({*child, world_from_node, false});
}

}  // namespace

std::vector<PlacedMesh> placed_meshes(Document& document) {
  Walk walk;
  const size_t nodes = length(document.root, "nodes");
  if (nodes == 0) {
    const size_t meshes = length(document.root, "meshes");
    for (size_t i = 0; i < meshes; ++i) walk.placed.push_back({std::nullopt, i, glm::dmat4(1.0)});
    if (meshes > 0) document.warnings.emplace_back("the file has no nodes: its meshes are drawn as they are");
    return walk.placed;
  }
  walk.states.assign(nodes, Walk::fresh);
  const std::vector<std::uint64_t> roots = root_nodes(document);
  for (auto node = roots.rbegin(); node != roots.rend(); ++node) walk.steps.push_back({*node, glm::dmat4(1.0), false});
  while (!walk.steps.empty()) {
    const Step step = walk.steps.back();
    walk.steps.pop_back();
    if (step.leave)
      walk.states[static_cast<size_t>(step.node)] = Walk::done;
    else
      enter(document, step, walk);
  }
  if (walk.hidden > 0) document.warnings.push_back(fmt::format("{} hidden nodes are not drawn", walk.hidden));
  if (walk.missing > 0) document.warnings.push_back(fmt::format("{} names of nodes that do not exist were ignored", walk.missing));
  if (walk.repeated > 0) document.warnings.push_back(fmt::format("{} nodes have several parents; each is drawn once", walk.repeated));
  return walk.placed;
}

}  // namespace limn::gltf
