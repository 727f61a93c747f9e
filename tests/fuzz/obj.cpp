// Wavefront OBJ with subdivision tags, as far as a render takes it before it meets a surface: read, checked, audited, triangulated,
// refined.
#include "subdiv/audit.h"
#include "subdiv/read_obj.h"
#include "subdiv/refine.h"
#include "tests/fuzz/fuzz_target.h"

namespace limn {
namespace {

/// Refinement is a library's, and what it costs grows with the file; small cages meet every rule.
constexpr size_t kMostFacesRefined = 64;
constexpr std::int64_t kMostElements = 100'000;

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

void use(std::string_view text) {
  const Mesh mesh = parse_obj(text, "fuzz.obj", kMostElements);
  validate(mesh, "fuzz.obj");
  mesh_facts(mesh);
  triangulate(mesh, NormalKind::vertex, true);
  if (mesh.face_count() <= kMostFacesRefined) refine_once(mesh);
}

}  // namespace
}  // namespace limn

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  limn::fuzz::only_refused([&] { limn::use(limn::fuzz::text_of(data, size)); });
  return 0;
}
