#include <algorithm>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "sdf/large_pages.h"
#include "sdf/parallel.h"
#include "subdiv/mesh_audit.h"
#include "subdiv/polygon.h"

namespace limn {
namespace {

struct EdgeUse {
  std::int32_t low, high, face, order;
  bool forward;
};

struct Corners {
  std::span<const std::int32_t> face_sizes, vertices;
  size_t vertex_count = 0;
};

/// A run of faces, and its first corner.
struct FaceRun {
  size_t first = 0, last = 0;
  std::int32_t corner = 0;
};

template <class Visit>
void visit_uses(const Corners& mesh, const FaceRun& run, Visit visit) {
  std::int32_t first = run.corner;
  for (size_t f = run.first; f < run.last; ++f) {
    const std::int32_t size = mesh.face_sizes[f];
    for (std::int32_t i = 0; i < size; ++i) {
      const std::int32_t at = first + i, next = i + 1 < size ? at + 1 : first;
      const std::int32_t a = mesh.vertices[static_cast<size_t>(at)], b = mesh.vertices[static_cast<size_t>(next)];
      // A corner repeated within a face makes an edge of no length, which is the face's fault and no edge of the mesh.
      if (a != b) visit(EdgeUse{std::min(a, b), std::max(a, b), static_cast<std::int32_t>(f), at, a < b});
    }
    first += size;
  }
}

/// At most eight: each counts uses at all vertices.
std::vector<FaceRun> runs_of(const Corners& mesh) {
  constexpr size_t kFaces = 32768, kMost = 8;
  const size_t faces = std::max((mesh.face_sizes.size() + kMost - 1) / kMost, kFaces);
  std::vector<FaceRun> runs;
  std::int32_t corner = 0;
  for (size_t f = 0; f < mesh.face_sizes.size(); ++f) {
    if (f % faces == 0) runs.push_back({f, std::min(f + faces, mesh.face_sizes.size()), corner});
    corner += mesh.face_sizes[f];
  }
  return runs;
}

/// Uses of edges by their lower vertex, then the higher one, then the order in the mesh.
struct SortedUses {
  PassingVector<EdgeUse> uses{};
  std::vector<std::uint32_t> ends{};  ///< [v]: behind the last one of vertex v.

  size_t first_of(size_t v) const { return v == 0 ? 0 : ends[v - 1]; }
};

/// Counted into their places by the lower vertex: few share one. Runs of faces by themselves; where they meet at a vertex, in their order.
SortedUses sorted_uses(const Corners& mesh) {
  const std::vector<FaceRun> runs = runs_of(mesh);
  std::vector<std::vector<std::uint32_t>> next(runs.size());
  parallel_each(runs.size(), [&](size_t r) {
    next[r].resize(mesh.vertex_count);
    visit_uses(mesh, runs[r], [&](const EdgeUse& use) { ++next[r][static_cast<size_t>(use.low)]; });
  });
  SortedUses sorted;
  sorted.ends.resize(mesh.vertex_count);
  std::uint32_t sum = 0;
  for (size_t v = 0; v < sorted.ends.size(); ++v) {
    for (std::vector<std::uint32_t>& of_run : next) sum += std::exchange(of_run[v], sum);
    sorted.ends[v] = sum;
  }
  sorted.uses.resize(sum);
  parallel_each(runs.size(), [&](size_t r) {
    visit_uses(mesh, runs[r], [&](const EdgeUse& use) { sorted.uses[next[r][static_cast<size_t>(use.low)]++] = use; });
  });
  const auto begin = sorted.uses.begin();
  parallel_for(size_t{0}, mesh.vertex_count, [&](size_t v) {
    std::sort(begin + static_cast<std::ptrdiff_t>(sorted.first_of(v)), begin + static_cast<std::ptrdiff_t>(sorted.ends[v]),
              [](const EdgeUse& x, const EdgeUse& y) { return std::tie(x.high, x.order) < std::tie(y.high, y.order); });
  });
  return sorted;
}

Edge edge_of(std::span<const EdgeUse> uses) {
  const EdgeUse& use = uses.front();
  Edge edge;
  edge.vertex_a = use.forward ? use.low : use.high;
  edge.vertex_b = use.forward ? use.high : use.low;
  edge.face_a = use.face;
  edge.face_count = static_cast<std::int32_t>(uses.size());
  if (uses.size() >= 2) {
    edge.face_b = uses[1].face;
    edge.consistent = uses[1].forward != use.forward;
  }
  return edge;
}

/// visit(the uses of an edge) for each edge whose lower vertex is one of `vertices`, in order.
template <class Visit>
void visit_edges(const SortedUses& sorted, const IndexRange<size_t>& vertices, Visit visit) {
  const size_t last = sorted.first_of(vertices.end());
  for (size_t i = sorted.first_of(vertices.begin()); i < last;) {
    size_t end = i + 1;
    while (end < last && sorted.uses[end].low == sorted.uses[i].low && sorted.uses[end].high == sorted.uses[i].high) ++end;
    visit(std::span(sorted.uses).subspan(i, end - i));
    i = end;
  }
}

}  // namespace

Edges build_edges(const Mesh& mesh) { return build_edges(mesh.face_sizes, mesh.corner_vertices, mesh.vertex_count()); }

Edges build_edges(std::span<const std::int32_t> face_sizes, std::span<const std::int32_t> corner_vertices, size_t vertex_count) {
  const SortedUses sorted = sorted_uses({face_sizes, corner_vertices, vertex_count});
  constexpr size_t kTogether = 16384;
  const auto stretch = [&](size_t i) { return IndexRange<size_t>{i * kTogether, std::min((i + 1) * kTogether, vertex_count)}; };
  std::vector<size_t> first((vertex_count + kTogether - 1) / kTogether + 1, 0);
  parallel_each(first.size() - 1, [&](size_t i) {
    size_t count = 0;
    visit_edges(sorted, stretch(i), [&](std::span<const EdgeUse>) { ++count; });
    first[i + 1] = count;
  });
  std::partial_sum(first.begin(), first.end(), first.begin());
  Edges edges(first.back());
  parallel_each(first.size() - 1, [&](size_t i) {
    size_t at = first[i];
    visit_edges(sorted, stretch(i), [&](std::span<const EdgeUse> uses) { edges[at++] = edge_of(uses); });
  });
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
