#pragma once
// Internal: the fields of a scene in solver space, those that overlap as one body.

#include <optional>
#include <string>
#include <vector>

#include "raymarch/scene.h"

namespace limn {

/// Everything in solver space.
struct FieldBodies {
  double extent = 1.0;
  std::vector<size_t> numbers{};  ///< Of each object, in the whole scene.
  std::vector<Field> fields{};
  /// Objects that overlap are one body, whose seams are creases like any other.
  std::vector<std::vector<size_t>> bodies{};
  std::vector<Field> body_fields{};
  std::vector<size_t> body_of{};  ///< Of each object.
};

/// `origin`: the world place of solver space's.
FieldBodies field_bodies(const Scene& scene, const std::vector<size_t>& objects, const glm::dvec3& origin, double extent);

/// The place among the fields of which object of a body a point lies on: where two of them meet, of the one with that normal.
int object_at(std::vector<FieldEvaluator>& evaluators, const std::vector<size_t>& body, const glm::dvec3& p, const glm::dvec3& normal,
              double extent);

/// The place among the fields of an object's number in the scene.
std::optional<size_t> place_of(const FieldBodies& bodies, int object);

/// For messages: "hub and bolt". `numbers` are the fields' places in the scene.
std::string name_of_body(const Scene& scene, const std::vector<size_t>& numbers, const std::vector<size_t>& body);

}  // namespace limn
