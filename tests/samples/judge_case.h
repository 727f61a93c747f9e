#pragma once
// Scenes that the judge's tests draw, and their drawings as they are read back.

#include <string>
#include <vector>

#include "samples/experiment/job.h"
#include "samples/judge/drawing_file.h"
#include "samples/judge/judge_lines.h"
#include "samples/lines/drawing.h"
#include "samples/lines/write_drawing.h"
#include "samples/scenes/scenes.h"
#include "tests/temporary_folder.h"

namespace limn::test {

/// The lines of a built-in scene, and limn's own drawing of them as it is read from its SVG.
struct Case {
  ViewGraph graph{};
  DrawnLines drawn{};  ///< The visible lines.
  std::string svg{};
};

inline DrawnLines read_back(const std::string& svg) {
  const TemporaryFolder folder;
  return read_drawing(folder.write("a.svg", svg), {}, {640, 360});
}

inline Case make_case(const std::string& name) {
  const Scene scene = find_scene(name)->make();
  CameraSettings settings = scene.camera;
  settings.width_px = 640;
  settings.height_px = 360;
  Case one;
  one.graph = solve_lines(scene, camera_of_view(settings, {bounds(scene), {}}, {}, 0, 1), {}, {});
  one.svg = svg_text(make_drawing(one.graph, 640, 360, {.style = built_in_style("plain")}), name);
  one.drawn = read_back(one.svg);
  return one;
}

inline const Case& part() {
  static const Case one = make_case("machined_part");
  return one;
}
inline const Case& torus() {
  static const Case one = make_case("tilted_torus");
  return one;
}

inline Judgement judged(const Case& one, const DrawnLines& drawing) { return judge_lines(one.graph, drawing, {}); }

inline double length_of(const std::vector<glm::dvec2>& points) {
  double length = 0.0;
  for (size_t i = 0; i + 1 < points.size(); ++i) length += glm::distance(points[i], points[i + 1]);
  return length;
}

}  // namespace limn::test
