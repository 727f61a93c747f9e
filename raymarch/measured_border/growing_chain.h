#pragma once
// A measured curve as a list that points are put into, and put on to.

#include <optional>

#include "raymarch/measured_border/chain.h"

namespace limn {

/// A point of a chain that grows: neighbours by index, so that points can be put between them.
struct ChainNode {
  static constexpr size_t kNone = static_cast<size_t>(-1);
  BorderPoint point{};
  double other_depth = 0.0;  ///< Of the other side, world units.
  size_t next = kNone;
};

struct GrowingChain {
  CurveKind kind = CurveKind::silhouette;
  int object = 0;
  bool closed = false;
  std::vector<ChainNode> nodes{};
  size_t first = 0, last = 0;
};

GrowingChain growing_chain(const BorderCurve& curve, const std::vector<double>& other_depths);
BorderCurve curve_of(const GrowingChain& chain);

/// Puts a point after the node `from`, before `to`; returns its index.
size_t put_between(GrowingChain& chain, size_t from, size_t to, ChainNode node);
/// Puts a point before the first or after the last node.
void put_beyond(GrowingChain& chain, bool at_last, ChainNode node);

/// Towards an end of an open chain, from its point nearest to the end that is at least `span_px` from it: the last chord alone may be too
/// short to have a direction. Unit; empty where all points coincide.
std::optional<glm::dvec2> end_direction(const GrowingChain& chain, bool at_last, double span_px);

/// True where depth changes by more along a chord than along any curve of one sheet: two sheets' curves were joined where they cross in
/// the image.
bool is_torn(const Camera& camera, const ChainNode& a, const ChainNode& b);
/// The pieces of a chain between torn chords; one piece where there are none.
std::vector<GrowingChain> cut_tears(const Camera& camera, const GrowingChain& chain);

}  // namespace limn
