#pragma once
// The objects of the benchmarks.

#include <optional>

#include "tests/bench/contestant.h"
#include "tests/bench/truth.h"

namespace limn::bench {

/// A shape of closed form with a fine regular mesh of it, or a mesh.
struct BenchObject {
  std::string name{};
  std::optional<Field> field{};
  TriangleMesh mesh{};
  TrueSurface closed_form{};  ///< Of a field.
};

/// sphere, torus, the first cage of a built-in scene (refined to level 4), or a mesh file. Throws InputError.
BenchObject bench_object(const std::string& name);
BenchObject bench_mesh_file(const std::string& file);
/// The middle of the object moved to the origin and its longest side made 2 for meshes; fields stay as they are.
BenchCase bench_case(const BenchObject& object, int voxels, int width_px, int height_px);

}  // namespace limn::bench
