// Edge functions of triangles about pixels, in vectors of doubles. As in the watertight test of Woop, Benthin and Wald (2013) they are made
// of the corners' places about the ray, which are the same in all triangles with that corner, and nothing is fused: the sign of each is
// right or 0, and 0 counts as inside on both sides of an edge, so that no ray slips between two triangles.
// Included once for each SIMD target.

#if defined(LIMN_MESH_EDGES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef LIMN_MESH_EDGES_INL_H
#undef LIMN_MESH_EDGES_INL_H
#else
#define LIMN_MESH_EDGES_INL_H
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace limn::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

/// A corner's place about a pixel.
struct Corner {
  V x, y;
};
HWY_INLINE Corner about(V corner_x, V corner_y, V x, V y) { return {hn::Sub(corner_x, x), hn::Sub(corner_y, y)}; }

/// Twice the area of the triangle between the pixel and two corners; swapped corners give exactly its negative.
HWY_INLINE V edge(const Corner& from, const Corner& to) { return hn::Sub(hn::Mul(to.x, from.y), hn::Mul(to.y, from.x)); }

/// What each corner weighs at the pixel, not yet divided by their sum.
struct EdgeWeights {
  V a, b, c;
};
HWY_INLINE EdgeWeights edge_weights(const Corner& a, const Corner& b, const Corner& c) { return {edge(b, c), edge(c, a), edge(a, b)}; }
HWY_INLINE V sum_of(const EdgeWeights& weights) { return hn::Add(hn::Add(weights.a, weights.b), weights.c); }

/// A triangle seen edge on meets nothing: its neighbours stop the ray.
HWY_INLINE M meets(const EdgeWeights& at, V sum) {
  const V zero = hn::Zero(D());
  const V least = hn::Min(hn::Min(at.a, at.b), at.c), most = hn::Max(hn::Max(at.a, at.b), at.c);
  return hn::And(hn::Or(hn::Ge(least, zero), hn::Le(most, zero)), hn::Ne(sum, zero));
}

}  // namespace limn::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
