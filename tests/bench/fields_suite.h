#pragma once
// Analytic fields: pictures of quadrics, unions and CSG beside the closed-form SIMD sphere and the memory-write floor.

#include <cstdio>
#include <nlohmann/json.hpp>

namespace limn::bench {

struct FieldsBenchSettings {
  int runs = 7;
  int width_px = 1920, height_px = 1080;  ///< The CSG scene is always 1024 x 1024.
  std::FILE* table = stdout;
};

/// Rows of kind "field": a scene in a picture, with hits, and what of them the double-precision walk along single rays sees otherwise.
nlohmann::json bench_fields(const FieldsBenchSettings& settings);

}  // namespace limn::bench
