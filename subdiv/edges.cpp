#include <algorithm>
#include <numeric>
#include <tuple>

#include "sdf/parallel.h"
#include "subdiv/mesh_audit.h"
#include "subdiv/polygon.h"

namespace limn {
namespace {

struct EdgeUse {
  std::int32_t low, high, face, order;
  bool forward;
};

template <class Visit>
void visit_uses(const Mesh& mesh, Visit visit) {
  std::int32_t first = 0;
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    const std::int32_t size = mesh.face_sizes[f];
    for (std::int32_t i = 0; i < size; ++i) {
      const std::int32_t at = first + i, next = i + 1 < size ? at + 1 : first;
      const std::int32_t a = mesh.corner_vertices[static_cast<size_t>(at)], b = mesh.corner_vertices[static_cast<size_t>(next)];
      // A corner repeated within a face makes an edge of no length, which is the face's fault and no edge of the mesh.
      if (a != b) visit(EdgeUse{std::min(a, b), std::max(a, b), static_cast<std::int32_t>(f), at, a < b});
    }
    first += size;
  }
}

/// By their lower vertex, then the higher one, then the order in the mesh. Counted into their places by the lower vertex: few share one.
std::vector<EdgeUse> sorted_uses(const Mesh& mesh) {
  std::vector<size_t> ends(mesh.vertex_count() + 1, 0);
  visit_uses(mesh, [&](const EdgeUse& use) { ++ends[static_cast<size_t>(use.low) + 1]; });
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  std::vector<EdgeUse> uses(ends.back());
  // Each start moves on to where the next vertex starts.
  visit_uses(mesh, [&](const EdgeUse& use) { uses[ends[static_cast<size_t>(use.low)]++] = use; });
  const auto begin = uses.begin();
  parallel_for(size_t{0}, mesh.vertex_count(), [&](size_t v) {
    const size_t start = v == 0 ? 0 : ends[v - 1];
    std::sort(begin + static_cast<std::ptrdiff_t>(start), begin + static_cast<std::ptrdiff_t>(ends[v]),
              [](const EdgeUse& x, const EdgeUse& y) { return std::tie(x.high, x.order) < std::tie(y.high, y.order); });
  });
  return uses;
}

}  // namespace

std::vector<Edge> build_edges(const Mesh& mesh) {
  const std::vector<EdgeUse> uses = sorted_uses(mesh);
  std::vector<Edge> edges;
  edges.reserve(uses.size() / 2 + 1);
  for (size_t i = 0; i < uses.size();) {
    size_t end = i + 1;
    while (end < uses.size() && uses[end].low == uses[i].low && uses[end].high == uses[i].high) ++end;
    const EdgeUse& use = uses[i];
    Edge edge;
    edge.vertex_a = use.forward ? use.low : use.high;
    edge.vertex_b = use.forward ? use.high : use.low;
    edge.face_a = use.face;
    edge.face_count = static_cast<std::int32_t>(end - i);
    if (end - i >= 2) {
      edge.face_b = uses[i + 1].face;
      edge.consistent = uses[i + 1].forward != use.forward;
    }
    edges.push_back(edge);
    i = end;
  }
  return edges;
}

std::int32_t part_of_faces(const Mesh& mesh, std::vector<std::int32_t>& part) {
  std::vector<std::int32_t> root(mesh.vertex_count());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&root](std::int32_t v) {
    while (root[static_cast<size_t>(v)] != v) {
      std::int32_t& up = root[static_cast<size_t>(v)];
      up = root[static_cast<size_t>(up)];
      v = up;
    }
    return v;
  };
  const std::vector<std::int32_t> first = first_corners(mesh);
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    const auto corners = face_corners(mesh, first[f], f);
    for (const std::int32_t v : corners.subspan(1)) {
      const std::int32_t a = find(corners[0]), b = find(v);
      if (a != b) root[static_cast<size_t>(std::max(a, b))] = std::min(a, b);
    }
  }
  std::vector<std::int32_t> number(mesh.vertex_count(), -1);
  std::int32_t count = 0;
  part.resize(mesh.face_count());
  for (size_t f = 0; f < mesh.face_count(); ++f) {
    const auto at = static_cast<size_t>(find(mesh.corner_vertices[static_cast<size_t>(first[f])]));
    if (number[at] < 0) number[at] = count++;
    part[f] = number[at];
  }
  return count;
}

}  // namespace limn
