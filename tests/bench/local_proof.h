#pragma once
// Local meshes as whole models: whether rays pass through them, whether they flicker, and what calls take that use them.

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace limn::bench {

struct LocalProofSettings {
  std::vector<std::string> scenes{};  ///< Empty: all.
  int runs = 7;                       ///< Of each call.
  std::string program{};              ///< The program limn; empty: the one beside this.
  std::FILE* table = stdout;
};

/// Every pixel of 36 views and 2 million random rays a scene, at local meshes for 0.25 px and at the finest meshes as fine everywhere; then
/// what flips along a path of 24 frames. One row a scene.
nlohmann::json bench_local_proof(const LocalProofSettings& settings);

/// Whole calls of `limn render --tolerance 0.25` with and without local meshes, and of the two models that they choose. One row a scene.
nlohmann::json bench_local_calls(const LocalProofSettings& settings);

}  // namespace limn::bench
