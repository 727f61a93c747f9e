#include "samples/judge/ink_edges.h"

#include <array>
#include <map>
#include <utility>

namespace limn {
namespace {

/// A side of a cell whose corners are four pixel centres: of the pixel it starts at, to the right or down.
using Side = std::pair<size_t, bool>;  // Pixel, down.

struct SideLinks {
  std::vector<Side> to{};  ///< One or two: the sides that the edge leads to.
  bool used = false;
};

using SideGraph = std::map<Side, SideLinks>;

constexpr float kHalf = 0.5f;

/// The sides of the cell, in turn: top, right, bottom, left.
std::array<Side, 4> sides_of(const Image<float>& coverage, int x, int y) {
  return {
      {{coverage.index(x, y), false}, {coverage.index(x + 1, y), true}, {coverage.index(x, y + 1), false}, {coverage.index(x, y), true}}};
}

void add_cell(const Image<float>& coverage, int x, int y, SideGraph& graph) {
  const std::array<bool, 4> in = {coverage.at(x, y) >= kHalf, coverage.at(x + 1, y) >= kHalf, coverage.at(x + 1, y + 1) >= kHalf,
                                  coverage.at(x, y + 1) >= kHalf};
  const std::array<Side, 4> sides = sides_of(coverage, x, y);
  std::vector<Side> crossed;
  for (size_t i = 0; i < 4; ++i)
    if (in[i] != in[(i + 1) % 4]) crossed.push_back(sides[i]);
  if (crossed.size() == 4) {
    // Two corners of ink across from each other: joined where the middle is ink.
    const float middle = coverage.at(x, y) + coverage.at(x + 1, y) + coverage.at(x + 1, y + 1) + coverage.at(x, y + 1);
    if ((middle >= 4.0f * kHalf) != in[0]) std::swap(crossed[0], crossed[2]);
  }
  for (size_t i = 0; i + 1 < crossed.size(); i += 2) {
    graph[crossed[i]].to.push_back(crossed[i + 1]);
    graph[crossed[i + 1]].to.push_back(crossed[i]);
  }
}

glm::dvec2 place_of(const Image<float>& coverage, const Side& side) {
  const auto width = static_cast<size_t>(coverage.width);
  const size_t column = side.first % width, row = side.first / width;
  const glm::dvec2 corner(static_cast<double>(column), static_cast<double>(row));
  const auto a = static_cast<double>(coverage.pixels[side.first]);
  const auto b = static_cast<double>(coverage.pixels[side.first + (side.second ? width : 1)]);
  const double t = (0.5 - a) / (b - a);
  return corner + 0.5 + (side.second ? glm::dvec2(0.0, t) : glm::dvec2(t, 0.0));
}

InkLine follow(const Image<float>& coverage, const Side& start, SideGraph& graph) {
  InkLine line;
  for (Side at = start;;) {
    SideLinks& links = graph.at(at);
    links.used = true;
    line.points.push_back(place_of(coverage, at));
    const Side* next = nullptr;
    for (const Side& to : links.to)
      if (!graph.at(to).used) next = &to;
    if (next == nullptr) {
      line.closed = line.points.size() > 2 && links.to.size() == 2 && (links.to[0] == start || links.to[1] == start);
      return line;
    }
    at = *next;
  }
}

}  // namespace

std::vector<InkLine> edges_of_ink(const Image<float>& coverage, const InkMask& mask) {
  SideGraph graph;
  for (int y = 0; y + 1 < coverage.height; ++y)
    for (int x = 0; x + 1 < coverage.width; ++x)
      if (mask.at(x, y) != 0 && mask.at(x + 1, y) != 0 && mask.at(x, y + 1) != 0 && mask.at(x + 1, y + 1) != 0)
        add_cell(coverage, x, y, graph);
  std::vector<InkLine> lines;
  // Open ones from their ends first.
  for (const size_t links : {size_t{1}, size_t{2}})
    for (const auto& [side, found] : graph)
      if (!found.used && found.to.size() == links) lines.push_back(follow(coverage, side, graph));
  std::erase_if(lines, [](const InkLine& line) { return line.points.size() < 2; });
  return lines;
}

}  // namespace limn
