#include "samples/judge/ink_thinning.h"

#include <algorithm>
#include <array>

namespace limn {
namespace {

/// Around a pixel, from the top clockwise.
constexpr std::array<glm::ivec2, 8> kAround = {{glm::ivec2(0, -1), glm::ivec2(1, -1), glm::ivec2(1, 0), glm::ivec2(1, 1), glm::ivec2(0, 1),
                                                glm::ivec2(-1, 1), glm::ivec2(-1, 0), glm::ivec2(-1, -1)}};

bool is_set(const InkMask& mask, const glm::ivec2& p) { return mask.inside(p.x, p.y) && mask.at(p.x, p.y) != 0; }

template <class Visit>
void for_pixels(const InkMask& mask, const Visit& visit) {
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x)
      if (mask.at(x, y) != 0) visit(glm::ivec2(x, y));
}

/// Offsets within a disk.
std::vector<glm::ivec2> disk(double radius) {
  std::vector<glm::ivec2> offsets;
  const int r = static_cast<int>(radius);
  for (int y = -r; y <= r; ++y)
    for (int x = -r; x <= r; ++x)
      if (x * x + y * y <= radius * radius) offsets.emplace_back(x, y);
  return offsets;
}

/// Whether a pass of Guo and Hall's thinning takes the pixel away: the line stays in one piece, and no end is lost.
bool peels(const InkMask& mask, const glm::ivec2& p, bool first) {
  std::array<bool, 8> set;
  for (size_t i = 0; i < 8; ++i) set[i] = is_set(mask, p + kAround[i]);
  int pieces = 0, pairs = 0, other_pairs = 0;
  for (size_t i = 0; i < 8; i += 2) {
    const bool after = set[i + 1], second = set[(i + 2) % 8], before = set[(i + 7) % 8];
    pieces += !set[i] && (after || second) ? 1 : 0;
    pairs += before || set[i] ? 1 : 0;
    other_pairs += set[i] || after ? 1 : 0;
  }
  const int count = std::min(pairs, other_pairs);
  if (pieces != 1 || count < 2 || count > 3) return false;
  const auto [up, up_right, right, down_right, down, down_left, left, up_left] = set;
  return first ? !((down || down_left || !up_left) && left) : !((up || up_right || !down_right) && right);
}

/// Those that continue a line: a diagonal one only where no straight one leads there.
std::vector<glm::ivec2> neighbours(const InkMask& mask, const glm::ivec2& p) {
  std::vector<glm::ivec2> found;
  for (const glm::ivec2& d : kAround) {
    if (!is_set(mask, p + d)) continue;
    if (d.x != 0 && d.y != 0 && (is_set(mask, p + glm::ivec2(d.x, 0)) || is_set(mask, p + glm::ivec2(0, d.y)))) continue;
    found.push_back(p + d);
  }
  return found;
}

/// From `from` over `next` to the next pixel that does not have two neighbours, or back to the start.
PixelLine follow(const InkMask& mask, const glm::ivec2& from, glm::ivec2 next, Image<std::uint8_t>& visited) {
  PixelLine line;
  line.pixels = {from};
  glm::ivec2 before = from;
  while (true) {
    line.pixels.push_back(next);
    const std::vector<glm::ivec2> around = neighbours(mask, next);
    if (around.size() != 2 || next == from) break;
    visited.at(next.x, next.y) = 1;
    const glm::ivec2 onwards = around[0] == before ? around[1] : around[0];
    before = next;
    next = onwards;
  }
  line.closed = line.pixels.size() > 2 && line.pixels.front() == line.pixels.back();
  line.junction_first = neighbours(mask, line.pixels.front()).size() > 2;
  line.junction_last = neighbours(mask, line.pixels.back()).size() > 2;
  if (line.closed) line.pixels.pop_back();
  return line;
}

std::vector<PixelLine> trace(const InkMask& mask) {
  std::vector<PixelLine> lines;
  Image<std::uint8_t> visited(mask.width, mask.height);
  for_pixels(mask, [&](const glm::ivec2& p) {
    const std::vector<glm::ivec2> around = neighbours(mask, p);
    if (around.size() == 2) return;
    for (const glm::ivec2& next : around) {
      const bool node = neighbours(mask, next).size() != 2;
      // Two nodes side by side would be found from either.
      if (node ? std::pair(next.y, next.x) < std::pair(p.y, p.x) : visited.at(next.x, next.y) != 0) continue;
      lines.push_back(follow(mask, p, next, visited));
    }
  });
  // What remains are loops without a junction.
  for_pixels(mask, [&](const glm::ivec2& p) {
    const std::vector<glm::ivec2> around = neighbours(mask, p);
    if (visited.at(p.x, p.y) != 0 || around.size() != 2) return;
    visited.at(p.x, p.y) = 1;
    lines.push_back(follow(mask, p, around[0], visited));
  });
  return lines;
}

}  // namespace

InkMask wide_ink(const Image<float>& coverage) {
  // Opened by a disk as wide as ink may be and still count as a line.
  constexpr double kThinRadius_px = 2.3;
  constexpr int kLeastCore = 12;
  const std::vector<glm::ivec2> inner = disk(kThinRadius_px), outer = disk(kThinRadius_px + 2.0);
  InkMask core(coverage.width, coverage.height), wide(coverage.width, coverage.height);
  const auto full = [&](const glm::ivec2& p) {
    return p.x < 0 || p.y < 0 || p.x >= coverage.width || p.y >= coverage.height || coverage.at(p.x, p.y) >= 0.5f;
  };
  for (int y = 0; y < core.height; ++y)
    for (int x = 0; x < core.width; ++x)
      core.at(x, y) = std::all_of(inner.begin(), inner.end(), [&](const glm::ivec2& d) { return full(glm::ivec2(x, y) + d); }) ? 1 : 0;
  // Where thin lines cross, a few pixels are as wide; they are no area.
  for_pixels(InkMask(core), [&](const glm::ivec2& start) {
    if (core.at(start.x, start.y) != 1) return;
    std::vector<glm::ivec2> piece = {start};
    core.at(start.x, start.y) = 2;
    for (size_t i = 0; i < piece.size(); ++i)
      for (const glm::ivec2& d : kAround) {
        const glm::ivec2 p = piece[i] + d;
        if (!core.inside(p.x, p.y) || core.at(p.x, p.y) != 1) continue;
        core.at(p.x, p.y) = 2;
        piece.push_back(p);
      }
    if (piece.size() < kLeastCore) return;
    for (const glm::ivec2& p : piece)
      for (const glm::ivec2& d : outer)
        if (wide.inside(p.x + d.x, p.y + d.y)) wide.at(p.x + d.x, p.y + d.y) = 1;
  });
  return wide;
}

void thin_to_lines(InkMask& mask) {
  // Guo and Hall 1989, "Parallel thinning with two-subiteration algorithms": unlike older ones it keeps diagonals two pixels wide.
  std::vector<glm::ivec2> ink, gone;
  for_pixels(mask, [&](const glm::ivec2& p) { ink.push_back(p); });
  for (bool changed = true; changed;) {
    changed = false;
    for (const bool first : {true, false}) {
      gone.clear();
      for (const glm::ivec2& p : ink)
        if (mask.at(p.x, p.y) != 0 && peels(mask, p, first)) gone.push_back(p);
      for (const glm::ivec2& p : gone) mask.at(p.x, p.y) = 0;
      changed = changed || !gone.empty();
    }
    std::erase_if(ink, [&](const glm::ivec2& p) { return mask.at(p.x, p.y) == 0; });
  }
}

std::vector<PixelLine> trace_pixel_lines(InkMask mask) {
  constexpr size_t kSpur = 3;
  for (const PixelLine& line : trace(mask)) {
    if (line.closed || line.pixels.size() > kSpur || line.junction_first == line.junction_last) continue;
    for (size_t i = 0; i < line.pixels.size(); ++i) {
      const bool junction = line.junction_first ? i == 0 : i + 1 == line.pixels.size();
      if (!junction) mask.at(line.pixels[i].x, line.pixels[i].y) = 0;
    }
  }
  return trace(mask);
}

}  // namespace limn
