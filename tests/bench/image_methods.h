#pragma once
// The image methods beside the OpenCV calls that do the like work.

#include <cstdio>
#include <nlohmann/json.hpp>

namespace limn::bench {

struct ImageBenchSettings {
  int runs = 7;
  int width_px = 1920, height_px = 1080;
  std::FILE* table = stdout;
};

/// Rows named "image", for one and for two threads. Each peer's row has `ours_over_peer` and the `limit` it is held to.
nlohmann::json bench_image_methods(const ImageBenchSettings& settings);

}  // namespace limn::bench
