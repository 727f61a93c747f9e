// Where two objects meet in the picture there is one line or none, and nothing small beside it.

#include "samples/stability/checks/check.h"
#include "samples/stability/checks/worst.h"

namespace limn {
namespace {

/// The seams that there are, are counted in a picture so many times as large.
constexpr int kFiner = 3;

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

bool is_seam(const GBuffer& seen, int x, int y) {
  const std::int32_t id = seen.id.at(x, y);
  const auto other = [&](int u, int v) { return seen.id.inside(u, v) && seen.id.at(u, v) != 0 && seen.id.at(u, v) != id; };
  return id != 0 && (other(x + 1, y) || other(x, y + 1));
}

bool near_background(const GBuffer& seen, int x, int y, int reach) {
  return any_near(seen, x, y, reach, [&](int u, int v) { return seen.id.at(u, v) == 0; });
}

/// Pixels beside another object, with or without ink near them; `away` from the background and the frame, since other outlines run there.
Image<std::uint8_t> seam_pixels(const GBuffer& seen, const Image<float>& ink, int reach, int away) {
  Image<std::uint8_t> seam(seen.width, seen.height, none);
  for (int y = away; y + away < seen.height; ++y) {
    for (int x = away; x + away < seen.width; ++x) {
      if (!is_seam(seen, x, y) || near_background(seen, x, y, away)) continue;
      seam.at(x, y) = any_near(seen, x, y, reach, [&](int u, int v) { return ink.at(u, v) > 0.5f; }) ? inked : bare;
    }
  }
  return seam;
}

/// Seams of which a part lies `away` from the background and the frame. What comes near them half way is one seam all the same.
std::int64_t count_seams(const GBuffer& seen, int away) {
  Image<std::uint8_t> all(seen.width, seen.height, 0);
  for (int y = 0; y < seen.height; ++y) {
    for (int x = 0; x < seen.width; ++x) all.at(x, y) = is_seam(seen, x, y);
  }
  const auto is_looked_at = [&](const glm::ivec2& p) {
    const bool within = p.x >= away && p.y >= away && p.x + away < seen.width && p.y + away < seen.height;
    return within && !near_background(seen, p.x, p.y, away);
  };
  const auto pieces = regions(all, [](std::uint8_t p) { return p != 0; });
  return std::count_if(pieces.begin(), pieces.end(),
                       [&](const auto& piece) { return std::any_of(piece.begin(), piece.end(), is_looked_at); });
}

StabilityFinding run(CaseContext& context, const MethodCall* method, const Parameters& with) {
  Worst worst;
  std::int64_t seen_in_any = 0;
  const int away = with.integer("away_px");
  for (size_t k = 0; k < context.views().size(); ++k) {
    const StabilityView& view = context.views()[k];
    const Border border = draw_border(context.stage(), view, *method);
    const Image<std::uint8_t> seam = seam_pixels(view.seen, border.coverage, with.integer("reach_px"), away);
    const auto count = [&](auto among) { return static_cast<std::int64_t>(regions(seam, among).size()); };
    // Half as far from the background, so that what lies there half way is among them.
    const std::int64_t seams = count_seams(view.seen, away), there = count_seams(context.fine_views(kFiner)[k].seen, kFiner * away / 2);
    const std::int64_t stretches = count([](std::uint8_t p) { return p != none; });
    const std::int64_t changes =
        count([](std::uint8_t p) { return p == bare; }) + count([](std::uint8_t p) { return p == inked; }) - stretches;
    // Along the outline of all objects other things break lines.
    const auto at_outline = [&](const glm::ivec2& p) {
      return any_near(view.seen, p.x, p.y, 3, [&](int u, int v) { return view.seen.id.at(u, v) == 0; });
    };
    std::int64_t specks = 0;
    for (const std::vector<glm::ivec2>& piece : regions(border.coverage, [](float ink) { return ink > 0.5f; })) {
      const bool small = static_cast<int>(piece.size()) < with.integer("speck_px");
      specks += small && std::none_of(piece.begin(), piece.end(), at_outline);
    }
    const std::int64_t splinters = std::max<std::int64_t>(0, seams - there);
    seen_in_any += seams;
    worst.see(static_cast<double>(changes + splinters + specks),
              fmt::format("{} seams in the picture of {}, {} changes between ink and none along them, {} specks of ink", seams, there,
                          changes, specks),
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
       stability_whole("speck_px", 6, 0, 1000, "pixels that a piece of ink has at least")},
      run};
}

}  // namespace limn
