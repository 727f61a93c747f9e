// Four neighbours: ink is the sum of 1 - n.n_i over the four neighbours.

#include <fmt/core.h>

#include <atomic>

#include "raymarch/border.h"
#include "raymarch/border/surface_notes.h"
#include "raymarch/gbuffer/picture_rows.h"

namespace limn {
namespace {

/// Lines of the normal buffer with its clear value and one repeated pixel at each end.
struct NormalLine {
  std::vector<float> x, y, z;
  explicit NormalLine(int width) : x(static_cast<size_t>(width) + 2), y(x.size()), z(x.size()) {}
};

void fill(const GBuffer& seen, const glm::vec3& clear, int row, NormalLine& out) {
  const size_t first = seen.id.index(0, std::clamp(row, 0, seen.height - 1)), width = static_cast<size_t>(seen.width);
  const glm::vec3* normal = seen.normal.pixels.data() + first;
  const std::int32_t* id = seen.id.pixels.data() + first;
  for (size_t i = 0; i < width; ++i) {
    const bool hit = id[i] != 0;
    out.x[i + 1] = hit ? normal[i].x : clear.x;
    out.y[i + 1] = hit ? normal[i].y : clear.y;
    out.z[i + 1] = hit ? normal[i].z : clear.z;
  }
  for (std::vector<float>* plane : {&out.x, &out.y, &out.z}) {
    plane->front() = (*plane)[1];
    plane->back() = (*plane)[width];
  }
}

/// saturate(sum of saturate(1 - n.n_i)); `offset` shifts the neighbour's line.
void add(const NormalLine& own, const NormalLine& other, size_t offset, int width, float* __restrict sum) {
  const float *ax = own.x.data() + 1, *ay = own.y.data() + 1, *az = own.z.data() + 1;
  const float *bx = other.x.data() + offset, *by = other.y.data() + offset, *bz = other.z.data() + offset;
  for (int x = 0; x < width; ++x) {
    const float dot = ax[x] * bx[x] + ay[x] * by[x] + az[x] * bz[x];
    sum[x] += std::min(1.0f, std::max(0.0f, 1.0f - dot));
  }
}

/// Pixels on the silhouette, and those of them without ink: there the normal is the clear value's, and no line can show.
void count_silhouette(const GBuffer& seen, int y, const float* ink, std::int64_t& all, std::int64_t& bare) {
  for (int x = 0; x < seen.width; ++x) {
    if (seen.id.at(x, y) == 0) continue;
    const auto empty = [&](int nx, int ny) { return seen.id.inside(nx, ny) && seen.id.at(nx, ny) == 0; };
    if (!empty(x - 1, y) && !empty(x + 1, y) && !empty(x, y - 1) && !empty(x, y + 1)) continue;
    ++all;
    bare += ink[x] < 0.5f;
  }
}

Border draw(const BorderInput& input, const Parameters& parameters) {
  const GBuffer& seen = input.gbuffer;
  const auto threshold = static_cast<float>(parameters.number("threshold"));
  const bool raw = parameters.choice("ink") == "raw";
  const glm::vec3 clear(input.camera.world_from_camera[2]);
  Border border;
  border.color = glm::vec3(parameters.vector3("color"));
  border.coverage = {seen.width, seen.height, 0.0f};
  std::atomic<std::int64_t> silhouette{0}, without_line{0};
  for_each_band(seen.height, [&](int y0, int y1) {
    NormalLine above(seen.width), own(seen.width), below(seen.width);
    fill(seen, clear, y0 - 1, above);
    fill(seen, clear, y0, own);
    std::int64_t all = 0, bare = 0;
    for (int y = y0; y < y1; ++y) {
      fill(seen, clear, y + 1, below);
      float* ink = &border.coverage.at(0, y);
      add(own, above, 1, seen.width, ink);
      add(own, below, 1, seen.width, ink);
      add(own, own, 0, seen.width, ink);
      add(own, own, 2, seen.width, ink);
      for (int x = 0; x < seen.width; ++x) ink[x] = raw ? std::min(1.0f, ink[x]) : (ink[x] >= threshold ? 1.0f : 0.0f);
      count_silhouette(seen, y, ink, all, bare);
      std::swap(above, own);
      std::swap(own, below);
    }
    silhouette += all;
    without_line += bare;
  });
  if (without_line > 0) {
    border.notes.push_back(fmt::format("normal4: {} of {} silhouette pixels have no line: their normals are near the clear value's",
                                       without_line.load(), silhouette.load()));
  }
  if (!input.with_notes) return border;
  if (std::string note = meetings_note("normal4", input, border.coverage, "their normals are alike there"); !note.empty()) {
    border.notes.push_back(std::move(note));
  }
  return border;
}

}  // namespace

BorderMethod normal4_method() {
  return {
      {"normal4", "border where the normals of the four neighbours differ from the pixel's own", "Saito and Takahashi 1990; Decaudin 1996"},
      {"N", "id"},
      {a_choice("ink", {"threshold", "raw"}).help("hard at the threshold, or the sum itself"),
       a_number("threshold", 0.4).in(1e-3, 1.0).help("ink where the sum of 1 - n.n_i over the neighbours reaches this"),
       a_color("color", {0.0, 0.0, 0.0}).help("ink, linear RGB")},
      [](const SceneModel&, const Scene&) { return std::string(); },
      draw};
}

}  // namespace limn
