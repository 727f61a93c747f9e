// A flat face is border or it is not.

#include "raymarch/border/surface_notes.h"
#include "samples/stability/checks/check.h"
#include "samples/stability/checks/worst.h"

namespace limn {
namespace {

StabilityFinding run(CaseContext& context, const MethodCall* method, const Parameters&) {
  Worst worst;
  for (const StabilityView& view : context.views()) {
    const Border border = draw_border(context.stage(), view, *method);
    std::int64_t pixels = 0, odd = 0, inked = 0;
    const std::vector<FlatFace> faces = flat_faces(view.seen, border.coverage);
    for (const FlatFace& face : faces) {
      pixels += face.pixels;
      odd += std::min(face.inked, face.pixels - face.inked);
      inked += 2 * face.inked > face.pixels;
    }
    const double share = pixels > 0 ? static_cast<double>(odd) / static_cast<double>(pixels) : 1.0;
    worst.see(share,
              fmt::format("{} flat faces, {} of them border; {} of {} pixels differ from the rest of their face", faces.size(), inked, odd,
                          pixels),
              context.stage(), view, &border);
  }
  return worst.take();
}

}  // namespace

StabilityCheck faces_whole_check() {
  return {{"faces_whole",
           "share of flat faces' pixels whose ink differs from that of most of their face; all of it where no flat face is seen", "limn"},
          "share",
          true,
          {},
          run};
}

}  // namespace limn
