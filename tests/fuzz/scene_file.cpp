// Scene files. The files that they name are not opened: every mesh is a tetrahedron, and there are no volumes.
#include <cmath>

#include "samples/input/scene_file.h"
#include "tests/fuzz/fuzz_target.h"

namespace limn {
namespace {

SceneReaders no_files() {
  SceneReaders readers;
  readers.mesh = [](const std::filesystem::path&) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.face_sizes = {3, 3, 3, 3};
    mesh.corner_vertices = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    return mesh;
  };
  readers.volume = [](const std::filesystem::path& file, const std::string&) -> LevelSet {
    throw InputError({file.string(), "", "", "no such file", "a volume (.vdb)"});
  };
  readers.vm = [](const std::filesystem::path& file) -> Field { throw InputError({file.string(), "", "", "no such file", "a .vm file"}); };
  return readers;
}

void use(const Field& field) {
  FieldEvaluator evaluator(field);
  const glm::dvec3 points[] = {{0.0, 0.0, 0.0}, {0.1, -0.7, 0.3}};
  double values[2];
  glm::dvec3 gradients[2];
  evaluator.gradients(points, values, gradients);
  for (const glm::dvec3& point : points) {
    const double value = evaluator.value(point);
    const Interval bounds = evaluator.bounds({point, point});
    fuzz::require(!std::isfinite(value) || (bounds.lower <= value && value <= bounds.upper), "a field outside its bounds");
  }
}

void use(const std::string& text) {
  const SceneInput input = parse_scene_file(text, "fuzz.toml", no_files());
  fuzz::require(!input.scene.objects.empty(), "an accepted scene without objects");
  for (const SceneObject& object : input.scene.objects)
    if (const Field* field = std::get_if<Field>(&object.source)) use(*field);
  resolve_camera(input.scene.camera, bounds(input.scene));
}

}  // namespace
}  // namespace limn

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  limn::fuzz::only_refused([&] { limn::use(std::string(limn::fuzz::text_of(data, size))); });
  return 0;
}
