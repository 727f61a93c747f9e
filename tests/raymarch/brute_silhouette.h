#pragma once
// The silhouette of a fine mesh by brute force: what every face and every edge of it says, and rays against all of it. Nothing here knows
// of patches, curves or chains.

#include <map>

#include "raymarch/gbuffer.h"
#include "tests/raymarch/scenes.h"

namespace limn::test {

struct BruteSegment {
  enum class Seen { hidden, visible, unclear };
  glm::dvec2 a{0.0}, b{0.0};
  double depth = 0.0;
  double floor_px = 0.0;    ///< How far the contour may be from this chord.
  glm::dvec2 outward{0.0};  ///< Unit, away from what it bounds; 0 where that is not clear.
  Seen seen = Seen::unclear;
  glm::dvec2 middle() const { return 0.5 * (a + b); }
  double length() const { return glm::distance(a, b); }
};

/// Coarser chords than this are not made up for.
inline constexpr double kMostFloor_px = 0.1;
inline constexpr double kSameNormal = 1e-3;

/// `fine` has limit normals at its corners, and stands in the world.
class BruteSilhouette {
 public:
  explicit BruteSilhouette(const Mesh& fine)
      : mesh_(fine), first_(first_corners(fine)), model_(model_of(scene_of({object_of(fine)}), "mesh")) {
    gather_edges();
    find_singular();
  }

  /// A tip in the picture, with all faces that touch it.
  struct Tip {
    glm::dvec2 px{0.0};
    double radius_px = 0.0;
  };
  std::vector<Tip> tips(const Camera& camera) const {
    const View view = look(camera);
    std::map<std::int32_t, double> radius;
    for (size_t f = 0; f < mesh_.face_count(); ++f) {
      const auto n = static_cast<size_t>(mesh_.face_sizes[f]);
      const auto px = [&](size_t i) { return glm::dvec2(view.image[static_cast<size_t>(vertex(f, i))]); };
      for (size_t i = 0; i < n; ++i) {
        if (!tip_[static_cast<size_t>(vertex(f, i))]) continue;
        double& farthest = radius[vertex(f, i)];
        for (size_t j = 0; j < n; ++j) farthest = std::max(farthest, glm::distance(px(i), px(j)));
      }
    }
    std::vector<Tip> found;
    for (const auto& [v, r] : radius) found.push_back({glm::dvec2(view.image[static_cast<size_t>(v)]), r});
    return found;
  }

  /// In the picture; whether something hides them is asked a little outside of them, and is unclear where nearby places differ.
  std::vector<BruteSegment> segments(const Camera& camera) const {
    const View view = look(camera);
    std::vector<BruteSegment> found;
    for (size_t f = 0; f < mesh_.face_count(); ++f) cross_face(view, f, found);
    for_each_edge([&](size_t begin, size_t end) {
      if (!smooth(begin, end)) cross_edge(view, begin, end, found);
    });
    std::erase_if(found, [&](const BruteSegment& s) {
      const glm::dvec2 m = s.middle();
      return !(m.x > 0.0 && m.y > 0.0 && m.x < camera.width_px && m.y < camera.height_px);
    });
    found = cut(found);
    hide(camera, found);
    return found;
  }

 private:
  struct EdgeUse {
    std::pair<std::int32_t, std::int32_t> ends;
    std::int32_t face = 0, corner = 0;
  };
  struct View {
    const Camera& camera;
    std::vector<glm::dvec3> image;  ///< Of vertices: px, depth.
  };

  std::int32_t vertex(size_t face, size_t corner) const {
    const auto n = static_cast<size_t>(mesh_.face_sizes[face]);
    return mesh_.corner_vertices[static_cast<size_t>(first_[face]) + corner % n];
  }
  glm::dvec3 normal(size_t face, size_t corner) const {
    const auto n = static_cast<size_t>(mesh_.face_sizes[face]);
    return mesh_.corner_normals[static_cast<size_t>(first_[face]) + corner % n];
  }
  const glm::dvec3& position(std::int32_t v) const { return mesh_.positions[static_cast<size_t>(v)]; }

  void gather_edges() {
    for (size_t f = 0; f < mesh_.face_count(); ++f)
      for (size_t i = 0; i < static_cast<size_t>(mesh_.face_sizes[f]); ++i)
        if (vertex(f, i) != vertex(f, i + 1))
          edges_.push_back({std::minmax(vertex(f, i), vertex(f, i + 1)), static_cast<std::int32_t>(f), static_cast<std::int32_t>(i)});
    std::stable_sort(edges_.begin(), edges_.end(), [](const EdgeUse& a, const EdgeUse& b) { return a.ends < b.ends; });
  }

  /// Where sheets touch the mesh's normals are not the limit's; around tips (sharp corners, ends of creases, ends of seams between sheets)
  /// its faces stay large on every level, and say little of the contours that run into them.
  void find_singular() {
    const size_t count = mesh_.vertex_count();
    singular_.assign(count, 0), tip_.assign(count, 0);
    std::vector<glm::dvec3> normal_at(count);
    std::vector<char> split(count, 0);
    std::vector<int> sharp(count, 0);
    for (size_t f = 0; f < mesh_.face_count(); ++f) {
      for (size_t i = 0; i < static_cast<size_t>(mesh_.face_sizes[f]); ++i) {
        const auto v = static_cast<size_t>(vertex(f, i));
        if (normal_at[v] == glm::dvec3(0.0)) normal_at[v] = normal(f, i);
        if (glm::distance(normal_at[v], normal(f, i)) > kSameNormal) split[v] = 1;
      }
    }
    for_each_edge([&](size_t begin, size_t end) {
      const auto a = static_cast<size_t>(edges_[begin].ends.first), b = static_cast<size_t>(edges_[begin].ends.second);
      const bool open = end - begin == 1, joined = end - begin == 2 && !agree(begin);
      if (!open && !joined) singular_[a] = singular_[b] = 1;
      if (!joined || (!smooth(begin, end) && split[a] && split[b])) ++sharp[a], ++sharp[b];
    });
    for (size_t v = 0; v < count; ++v) tip_[v] = split[v] && sharp[v] != 2;
  }

  template <class Visit>
  void for_each_edge(const Visit& visit) const {
    for (size_t e = 0, end = 0; e < edges_.size(); e = end) {
      while (end < edges_.size() && edges_[end].ends == edges_[e].ends) ++end;
      visit(e, end);
    }
  }
  /// The edge's first two faces run along it the same way.
  bool agree(size_t e) const {
    const auto from = [&](size_t k) { return vertex(static_cast<size_t>(edges_[k].face), static_cast<size_t>(edges_[k].corner)); };
    return from(e) == from(e + 1);
  }

  /// Two faces that run along it opposite ways and have the same normals there.
  bool smooth(size_t begin, size_t end) const {
    if (end - begin != 2) return false;
    const auto face = [&](size_t e) { return static_cast<size_t>(edges_[e].face); };
    const auto corner = [&](size_t e) { return static_cast<size_t>(edges_[e].corner); };
    const size_t a = begin, b = begin + 1;
    if (agree(begin)) return false;
    return glm::distance(normal(face(a), corner(a)), normal(face(b), corner(b) + 1)) < kSameNormal &&
           glm::distance(normal(face(a), corner(a) + 1), normal(face(b), corner(b))) < kSameNormal;
  }

  View look(const Camera& camera) const {
    View view{camera, {}};
    for (const glm::dvec3& p : mesh_.positions) view.image.push_back(project(camera, p));
    return view;
  }

  /// The contour between the places on the face's edges where N.V changes its sign.
  void cross_face(const View& view, size_t f, std::vector<BruteSegment>& found) const {
    const auto n = static_cast<size_t>(mesh_.face_sizes[f]);
    std::vector<double> facing;
    for (size_t i = 0; i < n; ++i) facing.push_back(glm::dot(normal(f, i), view_vector(view.camera, position(vertex(f, i)))));
    std::vector<glm::dvec3> places, normals;
    for (size_t i = 0; i < n; ++i) {
      const double f0 = facing[i], f1 = facing[(i + 1) % n];
      if ((f0 < 0.0) == (f1 < 0.0)) continue;
      const double t = f0 / (f0 - f1);
      places.push_back(glm::mix(position(vertex(f, i)), position(vertex(f, i + 1)), t));
      normals.push_back(glm::mix(normal(f, i), normal(f, i + 1), t));
    }
    for (size_t k = 0; k + 1 < places.size(); k += 2) {
      BruteSegment segment = segment_of(view, places[k], places[k + 1]);
      segment.floor_px = floor_of(view, f);
      if (places.size() == 2) segment.outward = fold_outward(view, f, facing, 0.5 * (places[0] + places[1]), normals[0] + normals[1]);
      found.push_back(segment);
    }
  }

  /// Between two corners whose normals differ by an angle the surface rises by an eighth of it over the chord.
  double floor_of(const View& view, size_t f) const {
    const auto n = static_cast<size_t>(mesh_.face_sizes[f]);
    const auto px = [&](size_t i) { return glm::dvec2(view.image[static_cast<size_t>(vertex(f, i))]); };
    double longest = 0.0, turn = 0.0;
    for (size_t i = 0; i < n; ++i) {
      for (size_t j = 0; j < i; ++j) {
        longest = std::max(longest, glm::distance(px(i), px(j)));
        turn = std::max(turn, glm::distance(normal(f, i), normal(f, j)));
      }
    }
    for (size_t i = 0; i < n; ++i)
      if (singular_[static_cast<size_t>(vertex(f, i))]) return kMostFloor_px;
    return std::min(kMostFloor_px, 0.125 * turn * longest);
  }

  static BruteSegment segment_of(const View& view, const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 p = project(view.camera, a), q = project(view.camera, b);
    BruteSegment segment;
    segment.a = glm::dvec2(p), segment.b = glm::dvec2(q), segment.depth = 0.5 * (p.z + q.z);
    return segment;
  }

  /// Along the normal where N.V rises towards the eye, else against it; unclear where it hardly does either (cusps). Its gradient in the
  /// face is that of the plane through the corners' values, by least squares.
  glm::dvec2 fold_outward(const View& view, size_t f, const std::vector<double>& facing, const glm::dvec3& p, const glm::dvec3& n) const {
    const glm::dvec3 v = view_vector(view.camera, p), across = glm::cross(glm::normalize(n), v);
    const size_t count = facing.size();
    glm::dvec3 mean(0.0);
    double mean_f = 0.0;
    for (size_t i = 0; i < count; ++i) mean += position(vertex(f, i)) / double(count), mean_f += facing[i] / double(count);
    double xx = 0.0, xy = 0.0, yy = 0.0, xf = 0.0, yf = 0.0;
    for (size_t i = 0; i < count; ++i) {
      const glm::dvec3 d = position(vertex(f, i)) - mean;
      const double x = glm::dot(d, v), y = glm::dot(d, across), df = facing[i] - mean_f;
      xx += x * x, xy += x * y, yy += y * y, xf += x * df, yf += y * df;
    }
    const double determinant = xx * yy - xy * xy, towards_eye = yy * xf - xy * yf, sideways = xx * yf - xy * xf;
    if (!(determinant > 1e-6 * xx * yy) || std::abs(towards_eye) < 0.05 * std::abs(sideways)) return glm::dvec2(0.0);
    const double step = 1e-3 / pixels_per_unit_at(view.camera, project(view.camera, p).z);
    const glm::dvec2 along = glm::dvec2(project(view.camera, p + step * glm::normalize(n))) - glm::dvec2(project(view.camera, p));
    return glm::normalize(along) * (towards_eye > 0.0 ? 1.0 : -1.0);
  }

  /// An edge where faces end or meet sharply: all of them on one side of it in the picture.
  void cross_edge(const View& view, size_t begin, size_t end, std::vector<BruteSegment>& found) const {
    BruteSegment segment = segment_of(view, position(edges_[begin].ends.first), position(edges_[begin].ends.second));
    const glm::dvec2 along = segment.b - segment.a, left(-along.y, along.x);
    int lefts = 0, rights = 0;
    for (size_t e = begin; e < end; ++e) {
      const auto f = static_cast<size_t>(edges_[e].face), n = static_cast<size_t>(mesh_.face_sizes[f]);
      glm::dvec2 center(0.0);
      for (size_t i = 0; i < n; ++i) center += glm::dvec2(view.image[static_cast<size_t>(vertex(f, i))]) / double(n);
      const double side = glm::dot(center - segment.middle(), left) / std::max(glm::dot(along, along), 1e-12);
      lefts += side > 0.01;
      rights += side < -0.01;
    }
    if (lefts > 0 && rights > 0) return;
    const auto count = static_cast<int>(end - begin);
    if (lefts == count || rights == count) segment.outward = glm::normalize(lefts > 0 ? -left : left);
    found.push_back(segment);
  }

  /// So short that where they begin to be hidden is known to that.
  static std::vector<BruteSegment> cut(const std::vector<BruteSegment>& segments) {
    constexpr double kLongest_px = 0.1;
    std::vector<BruteSegment> pieces;
    for (const BruteSegment& segment : segments) {
      const int count = std::max(1, static_cast<int>(std::ceil(segment.length() / kLongest_px)));
      for (int i = 0; i < count; ++i) {
        BruteSegment piece = segment;
        piece.a = glm::mix(segment.a, segment.b, static_cast<double>(i) / count);
        piece.b = glm::mix(segment.a, segment.b, static_cast<double>(i + 1) / count);
        pieces.push_back(piece);
      }
    }
    return pieces;
  }

  void hide(const Camera& camera, std::vector<BruteSegment>& found) const {
    constexpr std::array kBeyond_px{0.01, 0.05, 0.15, 0.4};
    std::vector<glm::dvec2> places;
    for (const BruteSegment& segment : found)
      for (const double beyond : kBeyond_px) places.push_back(segment.middle() + beyond * segment.outward);
    std::vector<PointSample> samples(places.size());
    sample_points(model_, camera, places, samples);
    for (size_t k = 0; k < found.size(); ++k) {
      BruteSegment& segment = found[k];
      if (segment.outward == glm::dvec2(0.0)) continue;
      const double nearer = segment.depth - 0.02 / pixels_per_unit_at(camera, segment.depth);
      size_t blocked = 0;
      for (size_t i = 0; i < kBeyond_px.size(); ++i) {
        const PointSample& s = samples[k * kBeyond_px.size() + i];
        blocked += s.status == HitStatus::hit && project(camera, s.position).z < nearer;
      }
      if (blocked == 0) segment.seen = BruteSegment::Seen::visible;
      if (blocked == kBeyond_px.size()) segment.seen = BruteSegment::Seen::hidden;
    }
  }

  const Mesh& mesh_;
  std::vector<std::int32_t> first_;
  SceneModel model_;
  std::vector<EdgeUse> edges_;
  std::vector<char> singular_, tip_;  ///< Of vertices.
};

}  // namespace limn::test
