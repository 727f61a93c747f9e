// The judge judged: limn's own lines score nothing, and whatever is done to them is found and named.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "run_program.h"
#include "samples/experiment/job.h"
#include "samples/judge/drawing_file.h"
#include "samples/judge/judge_lines.h"
#include "samples/lines/drawing.h"
#include "samples/lines/write_drawing.h"
#include "samples/scenes/scenes.h"
#include "sdf/error.h"
#include "tests/random_seed.h"
#include "tests/temporary_folder.h"

namespace limn {
namespace {

constexpr int kTries = 100;

/// The lines of a built-in scene, and limn's own drawing of them as it is read from its SVG.
struct Case {
  ViewGraph graph{};
  DrawnLines drawn{}, all{};  ///< The visible lines; hidden ones too, in the order of the graph's chains.
  std::string svg{};
};

DrawnLines read_back(const std::string& svg) {
  const TemporaryFolder folder;
  return read_drawing(folder.write("a.svg", svg), {}, {640, 360});
}

Case make_case(const std::string& name) {
  const Scene scene = find_scene(name)->make();
  CameraSettings settings = scene.camera;
  settings.width_px = 640;
  settings.height_px = 360;
  Case one;
  one.graph = solve_lines(scene, camera_of_view(settings, bounds(scene), 0, 1), {}, {});
  one.svg = svg_text(make_drawing(one.graph, 640, 360, {.style = built_in_style("plain")}), name);
  one.drawn = read_back(one.svg);
  return one;
}

const Case& part() {
  static const Case one = make_case("machined_part");
  return one;
}
const Case& torus() {
  static const Case one = make_case("tilted_torus");
  return one;
}

double length_of(const std::vector<glm::dvec2>& points) {
  double length = 0.0;
  for (size_t i = 0; i + 1 < points.size(); ++i) length += glm::distance(points[i], points[i + 1]);
  return length;
}

Judgement judged(const Case& one, const DrawnLines& drawing) { return judge_lines(one.graph, drawing, {}); }

/// The longest finding of a kind that comes within 3 px of the stroke; 0 where there is none.
double found_along(const Judgement& judgement, FindingKind kind, const std::vector<glm::dvec2>& stroke) {
  double longest = 0.0;
  for (const JudgeFinding& finding : judgement.findings) {
    const auto near = [&](const glm::dvec2& p) { return glm::distance(p, finding.px) < 3.0; };
    if (finding.kind == kind && std::any_of(stroke.begin(), stroke.end(), near)) longest = std::max(longest, finding.length_px);
  }
  return longest;
}

/// Points of a polyline at most half a pixel apart.
std::vector<glm::dvec2> dense(const std::vector<glm::dvec2>& points) {
  std::vector<glm::dvec2> result;
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    const int count = 1 + static_cast<int>(2.0 * glm::distance(points[i], points[i + 1]));
    for (int k = 0; k < count; ++k) result.push_back(glm::mix(points[i], points[i + 1], 1.0 * k / count));
  }
  result.push_back(points.back());
  return result;
}

/// An index of one of the lines that are long enough to be seen.
size_t any_line(const DrawnLines& drawing, double least_px, std::mt19937& random) {
  while (true) {
    const size_t i = random() % drawing.lines.size();
    if (length_of(drawing.lines[i].points) >= least_px) return i;
  }
}

void expect_clean(const Judgement& judgement) {
  EXPECT_EQ(judgement.all.missed_px, 0.0);
  EXPECT_EQ(judgement.all.false_px, 0.0);
  EXPECT_EQ(judgement.all.hidden_px, 0.0);
  EXPECT_EQ(judgement.all.doubled_px, 0.0);
  EXPECT_LE(judgement.all.displacement.p95, 0.01);
  EXPECT_LE(judgement.all.displacement.worst, 0.01);
  EXPECT_EQ(judgement.all.gaps, 0);
  EXPECT_EQ(judgement.all.pieces, judgement.all.chains);
  EXPECT_FALSE(judgement.shift.significant);
  EXPECT_TRUE(judgement.findings.empty());
}

TEST(Judge, FindsNothingInLimnsOwnDrawing) {
  expect_clean(judged(part(), part().drawn));
  expect_clean(judged(torus(), torus().drawn));
}

TEST(Judge, FindsEveryShiftByATenthOfAPixel) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> angle(0.0, 2.0 * std::numbers::pi);
  for (const Case* one : {&part(), &torus()}) {
    for (int i = 0; i < kTries; ++i) {
      const double a = angle(random);
      const glm::dvec2 shift(0.1 * std::cos(a), 0.1 * std::sin(a));
      DrawnLines moved = one->drawn;
      for (InkLine& line : moved.lines)
        for (glm::dvec2& p : line.points) p += shift;
      const Judgement judgement = judged(*one, moved);
      ASSERT_TRUE(judgement.shift.significant) << a;
      EXPECT_NEAR(judgement.shift.px.x, shift.x, 0.005);
      EXPECT_NEAR(judgement.shift.px.y, shift.y, 0.005);
      EXPECT_GT(judgement.all.displacement.rms, 0.03);
      EXPECT_LE(judgement.all.displacement.worst, 0.12);
      EXPECT_LT(judgement.all.missed_px + judgement.all.false_px, 0.5);
      EXPECT_TRUE(judgement.findings.empty());
    }
  }
}

TEST(Judge, NamesEveryStrokeThatIsDropped) {
  std::mt19937 random(random_seed());
  for (int i = 0; i < kTries; ++i) {
    DrawnLines less = part().drawn;
    const size_t gone = any_line(less, 3.0, random);
    const std::vector<glm::dvec2> points = dense(less.lines[gone].points);
    less.lines.erase(less.lines.begin() + static_cast<std::ptrdiff_t>(gone));
    const Judgement judgement = judged(part(), less);
    EXPECT_GT(judgement.all.missed_px, 0.5 * length_of(points)) << gone << " at " << points.front().x << " " << points.front().y;
    EXPECT_GT(found_along(judgement, FindingKind::missed, points), 0.25) << gone;
    EXPECT_EQ(judgement.all.false_px + judgement.all.doubled_px + judgement.all.hidden_px, 0.0);
  }
}

TEST(Judge, NamesEveryStrokeThatIsDrawnTwice) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> off(-0.2, 0.2);
  for (int i = 0; i < kTries; ++i) {
    DrawnLines more = part().drawn;
    InkLine again = more.lines[any_line(more, 3.0, random)];
    const glm::dvec2 shift(off(random), off(random));
    for (glm::dvec2& p : again.points) p += i % 2 == 0 ? glm::dvec2(0.0) : shift;
    if (i % 3 == 0) std::reverse(again.points.begin(), again.points.end());
    more.lines.push_back(again);
    const Judgement judgement = judged(part(), more);
    const double length = length_of(again.points) + (again.closed ? glm::distance(again.points.front(), again.points.back()) : 0.0);
    // Beside a neighbour within 0.3 px nobody can tell which one is drawn twice.
    EXPECT_GT(judgement.all.doubled_px, 0.5 * length);
    EXPECT_LT(judgement.all.doubled_px, 1.2 * length + 0.5);
    EXPECT_GT(found_along(judgement, FindingKind::doubled, dense(again.points)), 0.25);
    EXPECT_EQ(judgement.all.missed_px, 0.0);
  }
}

TEST(Judge, NamesEveryStrokeThatIsNoLine) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> x(20.0, 620.0), y(20.0, 340.0);
  for (int i = 0; i < kTries; ++i) {
    DrawnLines more = part().drawn;
    const glm::dvec2 from(x(random), y(random)), to(x(random), y(random));
    const glm::dvec2 step = (to - from) * std::min(1.0, 40.0 / glm::distance(from, to));
    more.lines.push_back({{from, from + step}, false, 1.0});
    const Judgement judgement = judged(part(), more);
    EXPECT_GT(judgement.all.false_px + judgement.all.hidden_px + judgement.all.doubled_px, 0.9 * glm::length(step) - 4.0);
    const double found = std::max({found_along(judgement, FindingKind::false_stroke, dense(more.lines.back().points)),
                                   found_along(judgement, FindingKind::hidden, dense(more.lines.back().points)),
                                   found_along(judgement, FindingKind::doubled, dense(more.lines.back().points))});
    EXPECT_GT(found, 0.25);
    EXPECT_EQ(judgement.all.missed_px, 0.0);
  }
}

TEST(Judge, NamesEveryHiddenLineThatIsShown) {
  std::mt19937 random(random_seed());
  const ViewGraph& graph = part().graph;
  std::vector<const LineChain*> hidden;
  for (const LineChain& chain : graph.chains)
    if (chain.invisibility > 0) hidden.push_back(&chain);
  ASSERT_FALSE(hidden.empty());
  for (int i = 0; i < kTries; ++i) {
    std::vector<glm::dvec2> points;
    const LineChain* shown = nullptr;
    while (length_of(points) < 3.0) {
      shown = hidden[random() % hidden.size()];
      points.clear();
      for (const LinePoint& p : points_of(graph, *shown)) points.push_back(p.px);
    }
    DrawnLines more = part().drawn;
    more.lines.push_back({points, shown->closed, 1.0});
    const Judgement judgement = judged(part(), more);
    // Where a visible line runs in front of it, there are two strokes on one line.
    EXPECT_GT(judgement.all.hidden_px + judgement.all.doubled_px, 0.7 * length_of(points));
    const double named = std::max(found_along(judgement, FindingKind::hidden, dense(points)), found_along(judgement, FindingKind::doubled, dense(points)));
    EXPECT_GT(named, 0.25) << name_of(shown->line_class) << " at " << points.front().x << " " << points.front().y;
    EXPECT_EQ(judgement.all.missed_px, 0.0);
  }
}

}  // namespace
}  // namespace limn
