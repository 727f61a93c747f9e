// Formulas (.vm): whatever is accepted is a field whose values lie within its bounds.
#include <cmath>

#include "sdf/vm_field.h"
#include "tests/fuzz/fuzz_target.h"

namespace limn {
namespace {

void use(std::string_view text) {
  const Field field = vm_field(text, "fuzz.vm").field;
  FieldEvaluator evaluator(field);
  for (const glm::dvec3& p : {glm::dvec3(0.0), glm::dvec3(0.1, -0.7, 0.3), glm::dvec3(900.0, -3.0, 20.0)}) {
    const FieldJet jet = evaluator.jet(p);
    fuzz::require(std::isfinite(jet.value) && std::isfinite(glm::length(jet.gradient)), "a value or a gradient that is not finite");
    const Interval bounds = evaluator.bounds({p - 0.1, p + 0.1});
    fuzz::require(bounds.lower <= jet.value && jet.value <= bounds.upper, "a value outside its bounds");
  }
}

}  // namespace
}  // namespace limn

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // What a list costs grows with it; short ones meet every rule.
  if (size > 4096) return 0;
  limn::fuzz::only_refused([&] { limn::use(limn::fuzz::text_of(data, size)); });
  return 0;
}
