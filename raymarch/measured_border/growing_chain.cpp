#include "raymarch/measured_border/growing_chain.h"

#include <algorithm>

namespace limn {
namespace {

constexpr size_t kNone = ChainNode::kNone;
/// Along a curve depth changes by no more than this and so much for each px, in px.
constexpr double kLeastTear_px = 1.0;
constexpr double kSteepest = 10.0;

GrowingChain chain_of(const GrowingChain& like, bool closed, std::vector<ChainNode> nodes) {
  GrowingChain chain{like.kind, like.object, closed, std::move(nodes), 0, 0};
  chain.last = chain.nodes.size() - 1;
  for (size_t k = 0; k < chain.nodes.size(); ++k) chain.nodes[k].next = k < chain.last ? k + 1 : closed ? 0 : kNone;
  return chain;
}

std::vector<ChainNode> in_order(const GrowingChain& chain) {
  std::vector<ChainNode> nodes;
  size_t i = chain.first;
  do {
    nodes.push_back(chain.nodes[i]);
    i = chain.nodes[i].next;
  } while (i != kNone && i != chain.first);
  return nodes;
}

}  // namespace

GrowingChain growing_chain(const BorderCurve& curve, const std::vector<double>& other_depths) {
  std::vector<ChainNode> nodes;
  for (size_t i = 0; i < curve.points.size(); ++i) nodes.push_back({curve.points[i], other_depths[i]});
  return chain_of({curve.kind, curve.object}, curve.closed, std::move(nodes));
}

BorderCurve curve_of(const GrowingChain& chain) {
  BorderCurve curve{chain.kind, chain.object, chain.closed, {}};
  for (const ChainNode& node : in_order(chain)) curve.points.push_back(node.point);
  return curve;
}

size_t put_between(GrowingChain& chain, size_t from, size_t to, ChainNode node) {
  node.next = to;
  chain.nodes.push_back(node);
  chain.nodes[from].next = chain.nodes.size() - 1;
  return chain.nodes.size() - 1;
}

void put_beyond(GrowingChain& chain, bool at_last, ChainNode node) {
  node.next = at_last ? kNone : chain.first;
  chain.nodes.push_back(node);
  const size_t end = chain.nodes.size() - 1;
  if (at_last) {
    chain.nodes[chain.last].next = end;
    chain.last = end;
  } else {
    chain.first = end;
  }
}

std::optional<glm::dvec2> end_direction(const GrowingChain& chain, bool at_last, double span_px) {
  const glm::dvec2 end = chain.nodes[at_last ? chain.last : chain.first].point.px;
  std::optional<glm::dvec2> before;
  for (size_t i = chain.first; i != kNone; i = chain.nodes[i].next) {
    const glm::dvec2 from = chain.nodes[i].point.px;
    const double distance = glm::distance(from, end);
    if (!(distance > 0.0)) continue;
    if (!at_last || !before || distance >= span_px) before = from;
    if (!at_last && distance >= span_px) break;
  }
  if (!before) return std::nullopt;
  return (end - *before) / glm::distance(end, *before);
}

bool is_torn(const Camera& camera, const ChainNode& a, const ChainNode& b) {
  const double nearer = std::min(a.point.depth, b.point.depth), step = std::abs(a.point.depth - b.point.depth);
  return step * pixels_per_unit_at(camera, nearer) > kLeastTear_px + kSteepest * glm::distance(a.point.px, b.point.px);
}

std::vector<GrowingChain> cut_tears(const Camera& camera, const GrowingChain& chain) {
  const std::vector<ChainNode> nodes = in_order(chain);
  std::vector<std::vector<ChainNode>> pieces(1);
  for (size_t i = 0; i < nodes.size(); ++i) {
    if (i > 0 && is_torn(camera, nodes[i - 1], nodes[i])) pieces.emplace_back();
    pieces.back().push_back(nodes[i]);
  }
  const bool runs_on = chain.closed && !is_torn(camera, nodes.back(), nodes.front()), whole = runs_on && pieces.size() == 1;
  if (runs_on && !whole) {
    pieces.back().insert(pieces.back().end(), pieces.front().begin(), pieces.front().end());
    pieces.erase(pieces.begin());
  }
  std::vector<GrowingChain> chains;
  chains.reserve(pieces.size());
  for (std::vector<ChainNode>& piece : pieces) chains.push_back(chain_of(chain, whole, std::move(piece)));
  return chains;
}

}  // namespace limn
