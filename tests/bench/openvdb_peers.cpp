// The peers that march grids: OpenVDB's own intersector, and NanoVDB with the hit refined and a gradient taken.

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"  // in nanovdb::HDDA, once inlined here
#endif

#include <nanovdb/NanoVDB.h>
#include <nanovdb/util/HDDA.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#include <nanovdb/util/Ray.h>
#include <nanovdb/util/SampleFromVoxels.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/RayIntersector.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <cmath>

#include "tests/bench/contestant.h"
#include "tests/bench/vdb_grid.h"

namespace limn::bench {
namespace {

Contestant openvdb_level_set_ray_intersector(const BenchCase& bench_case, const openvdb::FloatGrid::Ptr& grid) {
  using Intersector = openvdb::tools::LevelSetRayIntersector<openvdb::FloatGrid>;
  auto prototype = std::make_shared<Intersector>(*grid);
  auto frame = std::make_shared<Frame>(bench_case.camera.width_px, bench_case.camera.height_px);
  const RayForms<double> forms = ray_forms(bench_case.camera);
  return {.key = "openvdb",
          .name = "OpenVDB LevelSetRayIntersector",
          .draw =
              [grid, prototype, frame, forms] {
                for_each_tile(frame->width, frame->height, [&](int x0, int y0, int x1, int y1) {
                  Intersector intersector(*prototype);
                  const openvdb::Vec3d eye(forms.eye.x, forms.eye.y, forms.eye.z);
                  for (int y = y0; y < y1; ++y) {
                    for (int x = x0; x < x1; ++x) {
                      const glm::dvec3 d = forms.direction(x, y);
                      const openvdb::math::Ray<openvdb::Real> ray(eye, openvdb::Vec3d(d.x, d.y, d.z));
                      openvdb::Vec3d hit, n;
                      openvdb::Real t = 0.0;
                      const size_t i = static_cast<size_t>(y) * static_cast<size_t>(frame->width) + static_cast<size_t>(x);
                      if (intersector.intersectsWS(ray, hit, n, t))
                        frame->hit(i, static_cast<float>(t), glm::vec3(n.x(), n.y(), n.z()));
                      else
                        frame->miss(i);
                    }
                  }
                });
              },
          .take = [frame](Frame& out) { copy(*frame, out); }};
}

using Grid = nanovdb::FloatGrid;
using IndexRay = nanovdb::Ray<float>;
using Vec3 = nanovdb::Vec3f;

/// Index rays by linear forms; `t` is then in voxels.
struct IndexForms {
  Vec3 eye, corner, right, down;
  Vec3 direction(int x, int y) const {
    Vec3 d = corner + right * static_cast<float>(x) + down * static_cast<float>(y);
    d.normalize();
    return d;
  }
};

IndexForms index_forms(const RayForms<double>& world, const openvdb::FloatGrid& grid) {
  const double voxel = grid.voxelSize()[0];
  const openvdb::Vec3d eye = grid.transform().worldToIndex(openvdb::Vec3d(world.eye.x, world.eye.y, world.eye.z));
  const auto form = [voxel](const glm::dvec3& v) { return Vec3(float(v.x / voxel), float(v.y / voxel), float(v.z / voxel)); };
  return {Vec3(float(eye[0]), float(eye[1]), float(eye[2])), form(world.corner), form(world.right), form(world.down)};
}

/// Where the trilinear value turns from positive to negative about `t`: bracketed, then by false position with the kept end's value
/// halved (Illinois), so that both ends close in. False where it does not turn within `reach`.
template <class Sampler>
bool refine(const Sampler& value, const Vec3& eye, const Vec3& direction, float close_enough, float reach, float& t) {
  const auto at = [&](float s) { return value(eye + direction * s); };
  constexpr float kStep = 0.75f;
  float a = t, value_a = at(a), b = a, value_b = value_a;
  const float first = t - reach, last = t + reach;
  while (value_a <= 0.0f) {
    if (a < first) return false;
    b = a, value_b = value_a;
    value_a = at(a -= kStep);
  }
  while (value_b > 0.0f) {
    if (b > last) return false;
    a = b, value_a = value_b;
    value_b = at(b += kStep);
  }
  for (int step = 0; step < 8; ++step) {
    t = a + (b - a) * value_a / (value_a - value_b);
    const float middle = at(t);
    if (std::fabs(middle) < close_enough) return true;
    if (middle > 0.0f) {
      a = t, value_a = middle, value_b *= 0.5f;
    } else {
      b = t, value_b = middle, value_a *= 0.5f;
    }
  }
  return true;
}

struct NanoPeer {
  std::shared_ptr<nanovdb::GridHandle<>> handle;
  IndexForms forms;
  float voxel_size;
};

/// The first crossing as nanovdb::ZeroCrossing finds it, at most a few times anew behind a place that turns out to be none.
struct AsZeroCrossing {
  template <class Accessor, class Sampler>
  bool operator()(const NanoPeer& peer, const Vec3& direction, const Accessor& accessor, const Sampler& value, float& t) const {
    float start = 0.0f;
    for (int attempt = 0; attempt < 4; ++attempt) {
      IndexRay ray(peer.forms.eye, direction, start, 1e10f);
      nanovdb::Coord ijk;
      float at_voxel = 0.0f;
      if (!nanovdb::ZeroCrossing(ray, accessor, ijk, at_voxel, t)) return false;
      // At grazing rays the crossing lies many voxels from the node that told of it.
      constexpr float kReach = 36.0f;
      start = t + kReach;
      if (refine(value, peer.forms.eye, direction, 1e-4f * peer.voxel_size, kReach, t)) return true;
    }
    return false;
  }
};

/// The same walk (an HDDA, voxel by voxel in the band), but the trilinear value is looked at wherever a voxel says that the surface may
/// be within its cell's reach: no crossing is missed for lying between nodes.
struct EveryCell {
  template <class Accessor, class Sampler>
  bool operator()(const NanoPeer& peer, const Vec3& direction, const Accessor& accessor, const Sampler& value, float& t) const {
    IndexRay ray(peer.forms.eye, direction, 0.0f, 1e10f);
    if (!ray.clip(accessor.root().bbox())) return false;
    const float near = 1.7320508f * peer.voxel_size;
    nanovdb::Coord ijk = nanovdb::RoundDown<nanovdb::Coord>(ray.start());
    nanovdb::HDDA<IndexRay> walk(ray, static_cast<int>(accessor.getDim(ijk, ray)));
    while (walk.step()) {
      ijk = nanovdb::RoundDown<nanovdb::Coord>(ray(walk.time() + 1.0001f));
      walk.update(ray, static_cast<int>(accessor.getDim(ijk, ray)));
      if (walk.dim() > 1 || !accessor.isActive(ijk)) continue;
      do {
        if (accessor.getValue(walk.voxel()) > near) continue;
        t = walk.time();
        if (first_in_cell(peer, direction, value, walk.next(), t)) return true;
      } while (walk.step() && accessor.isActive(walk.voxel()));
    }
    return false;
  }

 private:
  /// Along a ray through one cell the value is a cubic: from four of its values its first root.
  template <class Sampler>
  static bool first_in_cell(const NanoPeer& peer, const Vec3& direction, const Sampler& value, float end, float& t) {
    const auto at = [&](float s) { return value(peer.forms.eye + direction * s); };
    constexpr int kParts = 3;
    float a = t, value_a = at(a);
    if (value_a <= 0.0f) return refine(value, peer.forms.eye, direction, 1e-4f * peer.voxel_size, 2.0f, t);
    const float step = (end - t) / kParts;
    for (int part = 0; part < kParts; ++part) {
      const float b = a + step, value_b = at(b);
      if (value_b <= 0.0f) {
        t = b;
        return refine(value, peer.forms.eye, direction, 1e-4f * peer.voxel_size, 2.0f, t);
      }
      a = b, value_a = value_b;
    }
    return false;
  }
};

template <class Find>
Contestant nanovdb_contestant(const BenchCase& bench_case, const NanoPeer& peer, const std::string& key, const std::string& name,
                              const Find& find) {
  auto frame = std::make_shared<Frame>(bench_case.camera.width_px, bench_case.camera.height_px);
  return {.key = key,
          .name = name,
          .draw =
              [peer, frame, find] {
                for_each_tile(frame->width, frame->height, [&](int x0, int y0, int x1, int y1) {
                  const auto accessor = peer.handle->template grid<float>()->getAccessor();
                  const auto value = nanovdb::createSampler<1>(accessor);
                  for (int y = y0; y < y1; ++y) {
                    for (int x = x0; x < x1; ++x) {
                      const size_t i = static_cast<size_t>(y) * static_cast<size_t>(frame->width) + static_cast<size_t>(x);
                      const Vec3 direction = peer.forms.direction(x, y);
                      float t = 0.0f;
                      if (!find(peer, direction, accessor, value, t)) {
                        frame->miss(i);
                        continue;
                      }
                      Vec3 n = value.gradient(peer.forms.eye + direction * t);
                      n.normalize();
                      frame->hit(i, t * peer.voxel_size, glm::vec3(n[0], n[1], n[2]));
                    }
                  }
                });
              },
          .take = [frame](Frame& out) { copy(*frame, out); }};
}

}  // namespace

std::vector<Contestant> vdb_peers(const BenchCase& bench_case) {
  const openvdb::FloatGrid::Ptr grid = openvdb_grid(bench_case.level_set);
  NanoPeer peer;
  peer.handle = std::make_shared<nanovdb::GridHandle<>>(nanovdb::openToNanoVDB(*grid));
  peer.forms = index_forms(ray_forms(bench_case.camera), *grid);
  peer.voxel_size = static_cast<float>(grid->voxelSize()[0]);
  return {openvdb_level_set_ray_intersector(bench_case, grid),
          nanovdb_contestant(bench_case, peer, "nanovdb", "NanoVDB ZeroCrossing, refined, gradient", AsZeroCrossing{}),
          nanovdb_contestant(bench_case, peer, "nanovdb.cells", "NanoVDB HDDA, every cell, gradient", EveryCell{})};
}

GridCost vdb_cost(const BenchCase& bench_case) {
  const openvdb::FloatGrid::Ptr grid = openvdb_grid(bench_case.level_set);
  GridCost cost;
  cost.openvdb_bytes = static_cast<double>(grid->memUsage());
  cost.nanovdb_conversion_ms = std::numeric_limits<double>::infinity();
  tbb::task_arena arena(2);
  for (int run = 0; run < 5; ++run) {
    const auto start = std::chrono::steady_clock::now();
    arena.execute([&] { cost.nanovdb_bytes = static_cast<double>(nanovdb::openToNanoVDB(*grid).size()); });
    const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    cost.nanovdb_conversion_ms = std::min(cost.nanovdb_conversion_ms, ms);
  }
  return cost;
}

}  // namespace limn::bench
