#include "raymarch/lines/surface_curves.h"
#include "sdf/error.h"

namespace limn {

LineContribution mesh_lines(const LineTask&, const std::vector<size_t>&, const ExecutionSettings&) { throw InputError({"", "", "", "mesh", ""}); }

}  // namespace limn
