// A scene and its variants draw the same picture.

#include <bit>

#include "samples/stability/checks/check.h"
#include "samples/stability/checks/worst.h"

namespace limn {
namespace {

bool same_bits(float a, float b) { return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b); }
bool same_bits(const glm::vec3& a, const glm::vec3& b) { return same_bits(a.x, b.x) && same_bits(a.y, b.y) && same_bits(a.z, b.z); }

struct Drawn {
  const StabilityView& view;
  const Border& border;
};

bool differ(const Drawn& a, const Drawn& b, size_t i, bool exact) {
  const GBuffer &p = a.view.seen, &q = b.view.seen;
  if (p.id.pixels[i] != q.id.pixels[i]) return true;
  if (!exact) return std::abs(a.border.coverage.pixels[i] - b.border.coverage.pixels[i]) > 0.5f;
  return !same_bits(p.depth.pixels[i], q.depth.pixels[i]) || !same_bits(p.normal.pixels[i], q.normal.pixels[i]) ||
         !same_bits(p.n_dot_v.pixels[i], q.n_dot_v.pixels[i]) || !same_bits(a.border.coverage.pixels[i], b.border.coverage.pixels[i]);
}

StabilityFinding run(CaseContext& context, const MethodCall* method, const Parameters& with) {
  const bool exact = with.flag("exact");
  Worst worst;
  for_each_variant(context, *method, worst, [&](const VariantView& both) {
    const auto& [changed, view, other, border, other_border] = both;
    worst.said(other_border.notes);
    std::int64_t different = 0;
    std::string first;
    for (size_t i = 0; i < view.seen.id.size(); ++i) {
      if (!differ({view, border}, {other, other_border}, i, exact)) continue;
      const auto width = static_cast<size_t>(view.seen.width);
      if (different++ == 0) first = fmt::format(", the first at ({}, {})", i % width, i / width);
    }
    const std::string words = fmt::format("{} of {} pixels differ with {}{}", different, view.seen.id.size(), changed.variant.words, first);
    worst.see(static_cast<double>(different), words, changed, other, &other_border);
  });
  return worst.take();
}

}  // namespace

StabilityCheck same_picture_check() {
  return {{"same_picture", "pixels that differ between the scene and its variants (other object, or ink across one half)", "limn"},
          "pixels",
          true,
          {a_flag("exact", false).help("every bit of depth, normal, N.V and ink counts")},
          run};
}

}  // namespace limn
