// Chains that keep their ids while the camera moves: events at angles that closed forms know, the same tracks backwards, and no id that
// jumps.

#include "raymarch/line_tracks.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "raymarch/frames.h"
#include "sdf/shape.h"

namespace limn {
namespace {

constexpr double kPi = std::numbers::pi;

Scene scene_of(const std::vector<Field>& fields) {
  Scene scene;
  for (const Field& field : fields) scene.objects.push_back({.name = "shape", .source = field});
  return scene;
}

Field ball(const glm::dvec3& center, double radius) { return translate(make_shape("sphere", {{"radius", {radius}}}), center); }

/// Seen from `eye`, orthographic; `height` world units are in the picture.
Camera parallel_camera(const glm::dvec3& eye, const glm::dvec3& up, double height) {
  CameraSettings settings;
  settings.eye = eye;
  settings.target = glm::dvec3(0.0);
  settings.up = up;
  settings.projection = Projection::orthographic;
  settings.ortho_height = height;
  settings.width_px = 320;
  settings.height_px = 240;
  return resolve_camera(settings, {glm::dvec3(-2.0), glm::dvec3(2.0)});
}

/// All frames of a camera that goes round the origin, and what was found between them.
struct Turned {
  std::vector<ViewGraph> graphs{};
  std::vector<std::vector<int>> ids{};
  LineTracks tracks{};
};

/// From `first` on by `step` radians a frame about `axis`; backwards where `back`.
Turned turn(const Scene& scene, const Camera& first, const glm::dvec3& axis, double step, int frames, bool back = false,
            const LineSettings& settings = {}) {
  Turned all;
  const GraphAt graph_at = [&](double time) {
    return solve_lines(scene, turned_camera(first, glm::dvec3(0.0), axis, step * (back ? frames - 1 - time : time)), settings, {});
  };
  for (int k = 0; k < frames; ++k) {
    all.graphs.push_back(graph_at(k));
    const ViewGraph& graph = all.graphs.back();
    all.ids.push_back(k == 0 ? first_ids(graph, all.tracks)
                             : follow_chains(all.graphs[all.graphs.size() - 2], all.ids.back(), k - 1, graph, k, graph_at, {}, all.tracks));
  }
  return all;
}

std::string list_of(const LineTracks& tracks) {
  std::string text;
  for (const ChainEvent& event : tracks.events)
    text += fmt::format("{} {} of {} between {} and {} at {}, {}: {} px\n", name_of(event.change), name_of(event.cause), event.id,
                        event.from, event.to, event.px.x, event.px.y, event.length_px);
  return text;
}

/// Ids of the visible chains of a frame.
std::set<int> visible_ids(const Turned& all, size_t frame) {
  std::set<int> ids;
  for (size_t c = 0; c < all.graphs[frame].chains.size(); ++c) {
    if (all.graphs[frame].chains[c].invisibility == 0) ids.insert(all.ids[frame][c]);
  }
  return ids;
}

TEST(LineTracks, ATurnedCameraLooksAtItsTargetFromTheSameDistance) {
  const Camera first = parallel_camera({1.0, 2.0, 3.0}, {0.0, 1.0, 0.0}, 3.0);
  const glm::dvec3 target(0.2, 0.1, -0.3);
  const Camera turned = turned_camera(first, target, {0.0, 2.0, 0.0}, 0.5 * kPi);
  // A quarter about +y carries +z to +x.
  const glm::dvec3 arm = first.eye - target;
  EXPECT_LT(glm::distance(turned.eye, target + glm::dvec3(arm.z, arm.y, -arm.x)), 1e-12);
  EXPECT_LT(glm::distance(glm::dvec3(project(first, target)), glm::dvec3(project(turned, target))), 1e-9);
  EXPECT_LT(glm::distance(turned_camera(turned, target, {0.0, 1.0, 0.0}, 1.5 * kPi).eye, first.eye), 1e-12);
}

TEST(LineTracks, ABallBehindAnotherVanishesAndComesBackAtTheAnglesOfInnerTangency) {
  constexpr double kBig = 0.9, kSmall = 0.5, kApart = 1.4, kStep = 10.0 * kPi / 180.0;
  const Scene scene = scene_of({ball({-0.5 * kApart, 0.0, 0.0}, kBig), ball({0.5 * kApart + kBig, 0.0, 0.0}, kSmall)});
  const double centers = kApart + kBig;
  const Turned all = turn(scene, parallel_camera({0.0, 0.0, 5.0}, {0.0, 1.0, 0.0}, 4.2), {0.0, 1.0, 0.0}, kStep, 36);
  // The small ball stands at +x: it is nearest the eye at 90 degrees and behind the big one at 270.
  const double off = std::asin((kBig - kSmall) / centers);
  ASSERT_EQ(all.tracks.events.size(), 2u) << list_of(all.tracks);
  const ChainEvent &gone = all.tracks.events[0], &back = all.tracks.events[1];
  EXPECT_EQ(gone.change, ChainChange::death);
  EXPECT_EQ(back.change, ChainChange::birth);
  for (const ChainEvent& event : all.tracks.events) {
    EXPECT_EQ(event.cause, ChainCause::tangency);
    EXPECT_LT(event.to - event.from, 0.51);
  }
  // An arc thinner than what the solver resolves counts as gone.
  constexpr double kNear = 1.0 * kPi / 180.0;
  EXPECT_NEAR(kStep * 0.5 * (gone.from + gone.to), 1.5 * kPi - off, kNear + 0.5 * kStep * (gone.to - gone.from)) << list_of(all.tracks);
  EXPECT_NEAR(kStep * 0.5 * (back.from + back.to), 1.5 * kPi + off, kNear + 0.5 * kStep * (back.to - back.from)) << list_of(all.tracks);
  // Both outlines keep their ids, open or closed, while they are seen.
  const std::set<int> first = visible_ids(all, 0);
  ASSERT_EQ(first.size(), 2u);
  for (size_t k = 0; k < all.graphs.size(); ++k) {
    const std::set<int> ids = visible_ids(all, k);
    const double angle = kStep * static_cast<double>(k);
    if (angle < 1.5 * kPi - off - kNear) {
      EXPECT_EQ(ids, first) << k;
    } else if (angle > 1.5 * kPi - off + kNear && angle < 1.5 * kPi + off - kNear) {
      EXPECT_EQ(ids.size(), 1u) << k;
    }
  }
}

TEST(LineTracks, ATorusThatTiltsHasItsSwallowtailsAndClosesItsHoleWhenTheEllipsesOffsetDoes) {
  constexpr double kMajor = 1.0, kMinor = 0.4, kStep = 5.0 * kPi / 180.0, kFirst = 41.0 * kPi / 180.0;
  const Scene scene = scene_of({make_shape("torus", {{"major", {kMajor}}, {"minor", {kMinor}}})});
  const Camera along = parallel_camera({0.0, 5.0, 0.0}, {0.0, 0.0, -1.0}, 3.2);
  const Camera first = turned_camera(along, glm::dvec3(0.0), {1.0, 0.0, 0.0}, kFirst);
  const Turned all = turn(scene, first, {1.0, 0.0, 0.0}, kStep, 8);
  // The outlines are the curves at the tube's radius from the ellipse that the torus' circle is seen as. The inner one gets cusps when the
  // ellipse's least radius of curvature falls below it (a parallel curve's cusps: Salmon 1879), and closes when its lesser axis does.
  const double swallowtails = (std::acos(std::sqrt(kMinor / kMajor)) - kFirst) / kStep,
               closes = (std::acos(kMinor / kMajor) - kFirst) / kStep;
  ASSERT_EQ(all.tracks.events.size(), 2u) << list_of(all.tracks);
  const ChainEvent &split = all.tracks.events[0], &death = all.tracks.events[1];
  EXPECT_EQ(split.change, ChainChange::split);
  EXPECT_EQ(split.cause, ChainCause::swallowtail);
  // One that is narrower than what the solver resolves comes a little later.
  EXPECT_GE(split.to, swallowtails) << list_of(all.tracks);
  EXPECT_LE(split.from, swallowtails + 0.2) << list_of(all.tracks);
  EXPECT_EQ(death.change, ChainChange::death);
  EXPECT_EQ(death.cause, ChainCause::tangency);
  EXPECT_NEAR(0.5 * (death.from + death.to), closes, 0.1) << list_of(all.tracks);
  EXPECT_EQ(visible_ids(all, 0).size(), 2u);
  EXPECT_EQ(visible_ids(all, 7).size(), 2u);
}

/// A scene in which much happens: a torus, a capped tube and two balls, in front of each other by turns.
Scene crowd() {
  return scene_of({make_shape("torus", {{"major", {0.9}}, {"minor", {0.28}}}), ball({1.5, 0.5, 0.2}, 0.35), ball({-0.2, -0.1, 1.3}, 0.25),
                   make_shape("capsule", {{"radius", {0.2}}, {"a", {-0.9, -0.5, -0.9}}, {"b", {-0.9, 1.0, -0.9}}})});
}

std::set<std::set<std::pair<size_t, size_t>>> partition(const Turned& all, bool back) {
  std::map<int, std::set<std::pair<size_t, size_t>>> of_id;
  for (size_t k = 0; k < all.ids.size(); ++k) {
    for (size_t c = 0; c < all.ids[k].size(); ++c) of_id[all.ids[k][c]].insert({back ? all.ids.size() - 1 - k : k, c});
  }
  std::set<std::set<std::pair<size_t, size_t>>> parts;
  for (const auto& [id, chains] : of_id) parts.insert(chains);
  return parts;
}

TEST(LineTracks, BackwardsInTimeTheTracksAreTheSame) {
  const Camera first = parallel_camera({1.0, 2.5, 4.0}, {0.0, 1.0, 0.0}, 4.6);
  constexpr double kStep = 6.0 * kPi / 180.0;
  const Turned there = turn(crowd(), first, {0.0, 1.0, 0.0}, kStep, 17), back = turn(crowd(), first, {0.0, 1.0, 0.0}, kStep, 17, true);
  EXPECT_EQ(there.tracks.events.size(), back.tracks.events.size());
  EXPECT_EQ(partition(there, false), partition(back, true));
  EXPECT_EQ(unexplained(there.tracks), 0) << list_of(there.tracks);
  EXPECT_GT(there.tracks.events.size(), 5u);
}

/// From each point of one chain to the nearest of the other, in space: the mean.
double mean_distance(const std::vector<LinePoint>& from, const std::vector<LinePoint>& to) {
  double sum = 0.0;
  for (const LinePoint& p : from) {
    double least = 1e9;
    for (size_t i = 0; i + 1 < to.size(); ++i) {
      const glm::dvec3 way = to[i + 1].position - to[i].position, d = p.position - to[i].position;
      const double squared = glm::dot(way, way), t = squared > 0.0 ? std::clamp(glm::dot(d, way) / squared, 0.0, 1.0) : 0.0;
      least = std::min(least, glm::length(d - t * way));
    }
    sum += least;
  }
  return sum / static_cast<double>(from.size());
}

TEST(LineTracks, LinesOfCurvatureAppearWholeAndAreNotSearchedForTheirBeginning) {
  const Scene scene = scene_of({make_shape("torus", {{"major", {1.0}}, {"minor", {0.38}}})});
  const Camera first = parallel_camera({0.0, 0.5, 4.0}, {0.0, 1.0, 0.0}, 3.6);
  constexpr int kFrames = 12;
  const Turned all = turn(scene, first, {1.0, 0.0, 0.0}, 7.0 * kPi / 180.0, kFrames, false,
                          {.classes = {LineClass::contour, LineClass::suggestive}, .suggestive_slope = 3.0});
  int appear = 0;
  for (const ChainEvent& event : all.tracks.events) {
    if (event.cause != ChainCause::cut_off) continue;
    ++appear;
    EXPECT_EQ(event.line_class, LineClass::suggestive) << list_of(all.tracks);
    EXPECT_GE(event.to - event.from, 0.25) << list_of(all.tracks);
    EXPECT_GT(event.length_px, 2.0) << list_of(all.tracks);
  }
  EXPECT_GE(appear, 1) << list_of(all.tracks);
  // A search for the moment of each would take the time between two frames apart 12 times.
  std::printf("%d appear or vanish, %lld graphs\n", appear, static_cast<long long>(all.tracks.solved));
  EXPECT_LE(all.tracks.solved, 60) << list_of(all.tracks);
}

TEST(LineTracks, EveryLineIsNearerToItsOwnIdThanToAnyOtherOfItsKind) {
  const Camera first = parallel_camera({1.0, 2.5, 4.0}, {0.0, 1.0, 0.0}, 4.6);
  constexpr double kStep = 1.0 * kPi / 180.0;
  const Turned all = turn(crowd(), first, {0.0, 1.0, 0.0}, kStep, 25);
  EXPECT_EQ(unexplained(all.tracks), 0) << list_of(all.tracks);
  size_t compared = 0;
  double worst = 0.0;
  for (size_t k = 0; k + 1 < all.graphs.size(); ++k) {
    const ViewGraph &now = all.graphs[k], &next = all.graphs[k + 1];
    for (size_t c = 0; c < now.chains.size(); ++c) {
      const LineChain& chain = now.chains[c];
      const auto own = std::find(all.ids[k + 1].begin(), all.ids[k + 1].end(), all.ids[k][c]);
      if (chain.invisibility > 0 || own == all.ids[k + 1].end()) continue;
      const LineChain& continued = next.chains[static_cast<size_t>(own - all.ids[k + 1].begin())];
      ASSERT_EQ(continued.line_class, chain.line_class);
      ASSERT_EQ(continued.invisibility, 0);
      const std::vector<LinePoint> points = points_of(now, chain), own_points = points_of(next, continued);
      // The shorter of the two lies along the longer one.
      const double apart = std::min(mean_distance(points, own_points), mean_distance(own_points, points));
      worst = std::max(worst, apart);
      for (const LineChain& other : next.chains) {
        if (&other == &continued || other.line_class != chain.line_class || other.invisibility > 0 || other.object != chain.object)
          continue;
        EXPECT_LE(apart, mean_distance(points, points_of(next, other))) << "frame " << k << ", id " << all.ids[k][c];
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 100u);
  // A point of a contour moves by the turn over the radial curvature; the tube of the torus and the balls bend by less than 1 / 0.2.
  EXPECT_LT(worst, 0.05);
}

TEST(LineTracks, AWanderingIdIsRefusedAndCounted) {
  // Frames that have nothing to do with each other: what cannot be followed is called unexplained, and never given the id of another line.
  const Scene one = scene_of({ball({-1.0, 0.0, 0.0}, 0.5)}), other = scene_of({ball({1.0, 0.6, 0.0}, 0.4), ball({1.0, -0.6, 0.0}, 0.4)});
  const Camera camera = parallel_camera({0.0, 0.0, 5.0}, {0.0, 1.0, 0.0}, 4.2);
  const ViewGraph before = solve_lines(one, camera, {}, {}), after = solve_lines(other, camera, {}, {});
  LineTracks tracks;
  const std::vector<int> ids = first_ids(before, tracks);
  TrackSettings settings;
  settings.most_halvings = 3;
  const GraphAt jump = [&](double time) { return solve_lines(time < 0.5 ? one : other, camera, {}, {}); };
  const std::vector<int> after_ids = follow_chains(before, ids, 0.0, after, 1.0, jump, settings, tracks);
  EXPECT_EQ(after_ids.size(), 2u);
  EXPECT_GE(unexplained(tracks), 1) << list_of(tracks);
}

}  // namespace
}  // namespace limn
