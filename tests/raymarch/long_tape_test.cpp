// Rays through fields of many parts, with tapes pruned as they go, against the same with the whole tape.

#include "raymarch/analytic/long_tape.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <bit>

#include "tests/random_seed.h"
#include "tests/sdf/random_field.h"

namespace limn::test {
namespace {

struct Marched {
  HitBatch hits{};
  void clear(int count) {
    for (int i = 0; i < count; ++i) hits.status[i] = HitStatus::miss, hits.t[i] = 0.0f;
  }
};

bool same_bits(float a, float b) { return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b); }

bool same(const HitBatch& a, const HitBatch& b, int i) {
  if (a.status[i] != b.status[i] || !same_bits(a.t[i], b.t[i])) return false;
  if (a.status[i] != HitStatus::hit) return true;
  // A part that does not matter may still have given a zero its sign.
  return a.normal_x[i] == b.normal_x[i] && a.normal_y[i] == b.normal_y[i] && a.normal_z[i] == b.normal_z[i];
}

/// From one eye towards the field, or from anywhere to anywhere.
RayBatch random_rays(Random& random, const Box& box, StretchList& list) {
  RayBatch rays;
  rays.count = 1 + random.index(kRayBatchSize);
  const glm::dvec3 eye = box.center() + random.uniform(0.5, 6.0) * box.radius() * random.direction();
  const bool coherent = random.index(2) == 0;
  for (int i = 0; i < rays.count; ++i) {
    const glm::dvec3 from = coherent ? eye : box.center() + random.uniform(0.0, 3.0) * box.radius() * random.direction();
    const glm::dvec3 to = box.center() + random.point(0.8 * box.radius());
    rays.set(i, from, glm::normalize(to - from), 0.0, glm::distance(from, to) + 2.0 * box.radius());
    list.add({i, 0, 0.0, static_cast<double>(rays.t_max[i]), 0.0});
  }
  return rays;
}

TEST(LongTape, PrunedAsRaysGoItHasTheHitsOfTheWholeOne) {
  Random random(random_seed());
  int fields = 0;
  std::int64_t hits = 0, misses = 0;
  FieldScratch memory;
  ViewScratch& scratch = memory.views.local();
  while (fields < 20) {
    const FieldTape tape(random_field(random, 5));
    const FieldTraits& traits = tape.field.traits();
    if (tape.leaves.size() < kLongTape || !traits.bounds.finite() || traits.bounds.empty()) continue;
    ++fields;
    const MarchLimits limits{
        .lipschitz = traits.lipschitz * (1.0 + 1e-6), .direction_length = 1.0 + 1e-6, .extent = traits.bounds.radius()};
    for (int batch = 0; batch < 4; ++batch) {
      StretchList list;
      const RayBatch rays = random_rays(random, traits.bounds, list);
      Marched whole, parts;
      whole.clear(rays.count), parts.clear(rays.count);
      sphere_trace({&tape, tape.steps}, limits, rays, scratch.tape, list, whole.hits);
      StretchList again = list;
      isolate({&tape, tape.steps}, limits, rays, scratch.tape, list, whole.hits);
      polish({&tape, tape.steps}, limits, rays, scratch.tape, list, whole.hits);
      isolate_in_parts(tape, limits, rays, scratch, again, parts.hits);
      for (int i = 0; i < rays.count; ++i) {
        if (whole.hits.status[i] == HitStatus::out_of_steps) parts.hits.status[i] = whole.hits.status[i], parts.hits.t[i] = whole.hits.t[i];
        EXPECT_TRUE(same(whole.hits, parts.hits, i))
            << "field " << fields << ", batch " << batch << ", ray " << i << ": " << static_cast<int>(whole.hits.status[i]) << " at "
            << whole.hits.t[i] << ", " << static_cast<int>(parts.hits.status[i]) << " at " << parts.hits.t[i];
        ++(whole.hits.status[i] == HitStatus::hit ? hits : misses);
      }
    }
  }
  EXPECT_GT(hits, 300);
  EXPECT_GT(misses, 50);
}

}  // namespace
}  // namespace limn::test
