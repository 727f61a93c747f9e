// Wavefront OBJ with subdivision tags, refined too.
#include "subdiv/read_obj.h"
#include "subdiv/refine.h"
#include "tests/fuzz/mesh_target.h"

namespace limn {
namespace {

/// Refinement is a library's, and what it costs grows with the file; small cages meet every rule.
constexpr size_t kMostFacesRefined = 64;

void refine_once(const Mesh& cage) {
  for (const Scheme scheme : {Scheme::catmark, Scheme::loop}) {
    fuzz::only_refused([&] {
      const RefinedSize predicted = predict_refined_size(cage, scheme, 1);
      const Mesh refined = refine(cage, {.scheme = scheme, .level = 1, .max_bytes = 1 << 26});
      fuzz::require(static_cast<std::int64_t>(refined.face_count()) == predicted.faces, "a refined size that was predicted wrongly");
      validate(refined, "refined");
    });
  }
}

}  // namespace
}  // namespace limn

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  limn::fuzz::only_refused([&] {
    const limn::Mesh mesh = limn::fuzz::use_mesh(limn::parse_obj, data, size);
    if (mesh.face_count() <= limn::kMostFacesRefined) limn::refine_once(mesh);
  });
  return 0;
}
