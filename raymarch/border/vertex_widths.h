#pragma once
// Widths of lines that files give: a channel of the colours of a mesh's vertices, at any point of its lines.

#include <memory>
#include <optional>
#include <vector>

#include "raymarch/scene.h"
#include "raymarch/surface.h"

namespace limn {

/// Which number of a linear colour counts.
enum class ColorChannel { luminance, red, green, blue };

/// Relative luminance (Rec. 709), or the channel itself.
double channel_of(const glm::vec3& color, ColorChannel channel);

/// What the vertices of a scene's meshes say, whichever model is drawn: that of the polygons that are traced, else of the mesh that the
/// object came from.
class VertexWidths {
 public:
  VertexWidths(const Scene& scene, const SceneModel& model, ColorChannel channel);
  ~VertexWidths();
  VertexWidths(const VertexWidths&) = delete;
  VertexWidths& operator=(const VertexWidths&) = delete;

  /// Objects (from 1) whose vertices have colours.
  bool has(int object) const;
  /// The channel at the point of the object's mesh that is closest to `position` (world), between its vertices as the colour is drawn;
  /// nothing for an object without vertex colours.
  std::optional<double> at(int object, const glm::dvec3& position) const;

 private:
  struct Painted;
  std::vector<std::unique_ptr<const Painted>> objects_;
  ColorChannel channel_;
};

}  // namespace limn
