// Where two objects meet in the picture there is one line or none, and nothing small beside it.

#include "samples/stability/checks/check.h"
#include "samples/stability/checks/worst.h"

namespace limn {
namespace {

enum SeamPixel : std::uint8_t { none = 0, bare = 1, inked = 2 };

/// The 8-connected regions of pixels for which `among(value)` holds.
template <class T, class Among>
std::vector<std::vector<glm::ivec2>> regions(const Image<T>& image, const Among& among) {
  std::vector<std::vector<glm::ivec2>> found;
  Image<std::uint8_t> taken(image.width, image.height, 0);
  std::vector<glm::ivec2> stack;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (taken.at(x, y) != 0 || !among(image.at(x, y))) continue;
      taken.at(x, y) = 1;
      stack = {{x, y}};
      found.emplace_back();
      while (!stack.empty()) {
        const glm::ivec2 p = stack.back();
        stack.pop_back();
        found.back().push_back(p);
        for (int v = p.y - 1; v <= p.y + 1; ++v) {
          for (int u = p.x - 1; u <= p.x + 1; ++u) {
            if (!image.inside(u, v) || taken.at(u, v) != 0 || !among(image.at(u, v))) continue;
            taken.at(u, v) = 1;
            stack.emplace_back(u, v);
          }
        }
      }
    }
  }
  return found;
}

template <class Among>
bool any_near(const GBuffer& seen, int x, int y, int reach, const Among& among) {
  for (int v = std::max(0, y - reach); v <= std::min(seen.height - 1, y + reach); ++v) {
    for (int u = std::max(0, x - reach); u <= std::min(seen.width - 1, x + reach); ++u) {
      if (among(u, v)) return true;
    }
  }
  return false;
}

/// Pixels beside another object, away from the background and the frame, where other outlines run: with or without ink near them.
Image<std::uint8_t> seam_pixels(const GBuffer& seen, const Image<float>& ink, int reach, int away) {
  Image<std::uint8_t> seam(seen.width, seen.height, none);
  for (int y = away; y + away < seen.height; ++y) {
    for (int x = away; x + away < seen.width; ++x) {
      const std::int32_t id = seen.id.at(x, y);
      const bool meets =
          (seen.id.at(x + 1, y) != id && seen.id.at(x + 1, y) != 0) || (seen.id.at(x, y + 1) != id && seen.id.at(x, y + 1) != 0);
      if (id == 0 || !meets || any_near(seen, x, y, away, [&](int u, int v) { return seen.id.at(u, v) == 0; })) continue;
      seam.at(x, y) = any_near(seen, x, y, reach, [&](int u, int v) { return ink.at(u, v) > 0.5f; }) ? inked : bare;
    }
  }
  return seam;
}

StabilityFinding run(CaseContext& context, const MethodCall* method, const Parameters& with) {
  Worst worst;
  std::int64_t seen_in_any = 0;
  for (const StabilityView& view : context.views()) {
    const Border border = draw_border(context.stage(), view, *method);
    const Image<std::uint8_t> seam = seam_pixels(view.seen, border.coverage, with.integer("reach_px"), with.integer("away_px"));
    const auto count = [&](auto among) { return static_cast<std::int64_t>(regions(seam, among).size()); };
    const std::int64_t seams = count([](std::uint8_t p) { return p != none; });
    const std::int64_t changes = count([](std::uint8_t p) { return p == bare; }) + count([](std::uint8_t p) { return p == inked; }) - seams;
    // Along the outline of all objects other things break lines.
    const auto at_outline = [&](const glm::ivec2& p) {
      return any_near(view.seen, p.x, p.y, 3, [&](int u, int v) { return view.seen.id.at(u, v) == 0; });
    };
    std::int64_t specks = 0;
    for (const std::vector<glm::ivec2>& piece : regions(border.coverage, [](float ink) { return ink > 0.5f; })) {
      const bool small = static_cast<int>(piece.size()) < with.integer("speck_px");
      specks += small && std::none_of(piece.begin(), piece.end(), at_outline);
    }
    const std::int64_t splinters = std::max<std::int64_t>(0, seams - with.integer("seams"));
    seen_in_any += seams;
    worst.see(static_cast<double>(changes + splinters + specks),
              fmt::format("{} seams in the picture, {} changes between ink and none along them, {} specks of ink", seams, changes, specks),
              context.stage(), view, &border);
  }
  if (seen_in_any == 0) {
    const StabilityView& view = context.views().front();
    worst.see(kNothingSeen, "no seam in any picture", context.stage(), view, nullptr);
  }
  return worst.take();
}

}  // namespace

StabilityCheck clean_seams_check() {
  return {
      {"clean_seams", "where objects meet in the picture: changes between ink and none along it, pieces too many, specks of ink", "limn"},
      "places",
      true,
      {stability_whole("reach_px", 4, 0, 64, "how far from the seam its line may run"),
       stability_whole("away_px", 8, 1, 64, "from the background, where other outlines run"),
       stability_whole("speck_px", 6, 0, 1000, "pixels that a piece of ink has at least"),
       stability_whole("seams", 1, 0, 1000, "places where objects meet")},
      run};
}

}  // namespace limn
