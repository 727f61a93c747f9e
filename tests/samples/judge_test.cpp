// The judge judged: limn's own lines score nothing, and whatever is done to them is found and named.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>

#include "run_program.h"
#include "tests/random_seed.h"
#include "tests/samples/judge_case.h"
#include "tests/temporary_folder.h"

namespace limn {
namespace {

using namespace test;

constexpr int kTries = 100;

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
  for (const Case* one : {&part(), &torus()}) {
    const Judgement judgement = judged(*one, one->drawn);
    expect_clean(judgement);
    EXPECT_GT(judgement.all.chains, 0);
  }
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
    const glm::dvec2 aside(off(random), off(random)), shift = i % 2 == 0 ? glm::dvec2(0.0) : aside;
    for (glm::dvec2& p : again.points) p += shift;
    if (i % 3 == 0) std::reverse(again.points.begin(), again.points.end());
    more.lines.push_back(again);
    const Judgement judgement = judged(part(), more);
    const double length = length_of(again.points) + (again.closed ? glm::distance(again.points.front(), again.points.back()) : 0.0);
    // Beside a neighbour within 0.3 px nobody can tell which one is drawn twice, and a copy drawn aside, nearer to a hidden line than to
    // its own, is that one.
    const double as_hidden = shift == glm::dvec2(0.0) ? 0.0 : judgement.all.hidden_px;
    EXPECT_GT(judgement.all.doubled_px + as_hidden, 0.5 * length);
    EXPECT_LT(judgement.all.doubled_px + as_hidden, 1.2 * length + 0.5);
    EXPECT_EQ(judgement.all.hidden_px, as_hidden);
    EXPECT_GT(found_along(judgement, FindingKind::doubled, dense(again.points)) +
                  found_along(judgement, FindingKind::hidden, dense(again.points)),
              0.25);
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
    const double named =
        std::max(found_along(judgement, FindingKind::hidden, dense(points)), found_along(judgement, FindingKind::doubled, dense(points)));
    EXPECT_GT(named, 0.25) << name_of(shown->line_class) << " at " << points.front().x << " " << points.front().y;
    EXPECT_EQ(judgement.all.missed_px, 0.0);
  }
}

/// LIMN_VIEWS=1000 looks at so many instead of a few.
TEST(Judge, RaisesNoAlarmForOtherViews) {
  std::mt19937 random(random_seed());
  std::normal_distribution<double> normal;
  const char* const wanted = std::getenv("LIMN_VIEWS");
  const int views = wanted != nullptr ? std::atoi(wanted) : 8;
  constexpr std::array kScenes{"machined_part", "passing_tori", "superellipsoid", "pipe_junction"};
  for (int i = 0; i < views; ++i) {
    const Scene scene = find_scene(kScenes[static_cast<size_t>(i) % kScenes.size()])->make();
    CameraSettings settings;
    settings.width_px = 640;
    settings.height_px = 360;
    settings.target = bounds(scene).center();
    settings.eye =
        *settings.target + 4.0 * bounds(scene).radius() * glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    const ViewGraph graph = solve_lines(scene, camera_of_view(settings, {bounds(scene), {}}, {}, 0, 1), {}, {});
    const Judgement judgement =
        judge_lines(graph, read_back(svg_text(make_drawing(graph, 640, 360, {.style = built_in_style("plain")}), "a")), {});
    expect_clean(judgement);
    EXPECT_GT(judgement.all.chains, 0) << scene.name;
  }
}

/// A graph of visible contours; each chain is a list of edges, each edge a list of points.
ViewGraph graph_of(const std::vector<std::vector<std::vector<glm::dvec2>>>& chains) {
  ViewGraph graph;
  for (const std::vector<std::vector<glm::dvec2>>& edges : chains) {
    LineChain chain;
    for (const std::vector<glm::dvec2>& points : edges) {
      LineEdge edge;
      for (const glm::dvec2& p : points) edge.points.push_back({.px = p, .depth = 1.0});
      edge.begin = static_cast<int>(graph.vertices.size());
      edge.end = edge.begin + 1;
      graph.vertices.resize(graph.vertices.size() + 2);
      chain.links.push_back({static_cast<int>(graph.edges.size()), false});
      graph.edges.push_back(std::move(edge));
    }
    graph.chains.push_back(std::move(chain));
  }
  return graph;
}

Judgement own_drawing_judged(const ViewGraph& graph) {
  return judge_lines(graph, read_back(svg_text(make_drawing(graph, 640, 360, {.style = built_in_style("plain")}), "a")), {});
}

/// A line that leaves another in a joint, at angles about those up to which lines run in one direction.
TEST(Judge, FindsNothingWhereOneLineLeavesAnother) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> offset(0.0, 0.001), angle(34.5, 35.5), turn(0.0, 2.0 * std::numbers::pi);
  for (int i = 0; i < 300; ++i) {
    const double start = turn(random), leaving = start + glm::radians(angle(random));
    const glm::dvec2 joint(300.0 + offset(random), 200.0 + offset(random));
    const auto from_joint = [&](double length, double direction) {
      return joint + length * glm::dvec2(std::cos(direction), std::sin(direction));
    };
    expect_clean(own_drawing_judged(graph_of(
        {{{from_joint(0.2, leaving), joint}, {joint, from_joint(30.0, leaving + std::numbers::pi)}}, {{joint, from_joint(0.15, start)}}})));
    if (HasFailure()) FAIL() << "angles " << start << " " << leaving;
  }
}

/// A line that turns back at the end of another, in a tip that the file's digits move.
TEST(Judge, FindsNothingWhereALineTurnsBackBesideAnother) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> offset(0.0, 0.001), turn(0.0, 2.0 * std::numbers::pi);
  for (int i = 0; i < 300; ++i) {
    const double direction = turn(random);
    const glm::dvec2 joint(300.0 + offset(random), 200.0 + offset(random)), along(std::cos(direction), std::sin(direction)),
        across(-along.y, along.x);
    const glm::dvec2 tip = joint + 0.6 * along;
    expect_clean(own_drawing_judged(graph_of(
        {{{tip + 30.0 * along, joint}}, {{joint, joint + 0.3 * along + 0.02 * across, tip, joint + 0.3 * along - 0.02 * across, joint}}})));
    if (HasFailure()) FAIL() << "direction " << direction;
  }
}

/// A line passes the tip of another one, which turns back beside it.
TEST(Judge, FindsNothingWhereALinePassesATip) {
  std::mt19937 random(random_seed());
  std::uniform_real_distribution<double> offset(0.0, 0.25), turn(0.0, 2.0 * std::numbers::pi);
  for (int i = 0; i < 300; ++i) {
    const double direction = turn(random);
    const glm::dvec2 middle(300.0 + offset(random), 200.0 + offset(random)), along(std::cos(direction), std::sin(direction)),
        across(-along.y, along.x);
    const auto at = [&](double u, double v) { return middle + u * along + v * across; };
    // Samples lie anywhere beside the tip.
    const double from = -20.0 - offset(random);
    expect_clean(own_drawing_judged(
        graph_of({{{at(-0.48, 0.0), at(0.0, 0.0), at(-0.18, 0.01), at(-0.43, 0.03), at(-0.88, 0.08), at(-5.0, 0.6), at(from, 8.0)}},
                  {{at(from, -0.013), at(20.0, -0.013)}}})));
    if (HasFailure()) FAIL() << "direction " << direction;
  }
}

TEST(Judge, DoesNotMissWhatNoFileHas) {
  const Judgement judgement =
      own_drawing_judged(graph_of({{{{100.0, 100.0}, {150.0, 120.0}}}, {{{300.00001, 200.0}, {300.00003, 200.0}}}}));
  expect_clean(judgement);
  EXPECT_EQ(judgement.all.chains, 2);
}

TEST(Judge, FindsNothingWhereEdgesOfAChainEndBesideEachOther) {
  const Judgement judgement = own_drawing_judged(graph_of({{{{100.0, 100.0}, {150.0, 120.0}}, {{150.01, 120.02}, {180.0, 90.0}}}}));
  expect_clean(judgement);
  EXPECT_EQ(judgement.all.chains, 1);
}

TEST(JudgeCommand, PassesLimnsOwnDrawingAndFailsAnotherView) {
  const TemporaryFolder folder;
  const std::string own = folder.write("own.svg", torus().svg), page = folder.file("own.html"), junit = folder.file("own.xml");
  const std::vector<std::string> limits = {"--max-missed",  "0", "--max-false",     "0px", "--max-hidden", "0%",
                                           "--max-doubled", "0", "--max-displaced", "0.01"};
  std::vector<std::string> call = {"judge", own, "--against", "tilted_torus", "-o", page, "--junit", junit};
  call.insert(call.end(), limits.begin(), limits.end());
  const RunResult passed = run_limn(call);
  EXPECT_EQ(passed.exit_code, 0) << passed.err << passed.out;
  EXPECT_NE(passed.out.find("no findings"), std::string::npos);
  EXPECT_NE(read_bytes(page).find("</html>"), std::string::npos);
  EXPECT_NE(read_bytes(junit).find("tests=\"5\" failures=\"0\""), std::string::npos) << read_bytes(junit);
  call.insert(call.end(), {"--eye", "3,2,4"});
  const RunResult failed = run_limn(call);
  EXPECT_EQ(failed.exit_code, 1) << failed.err;
  EXPECT_NE(failed.out.find("FAILED: missed"), std::string::npos);
  EXPECT_NE(failed.out.find("another view"), std::string::npos);
  EXPECT_EQ(read_bytes(junit).find("failures=\"0\""), std::string::npos);
}

TEST(JudgeCommand, KnowsTheLinesThatWereAskedFor) {
  const TemporaryFolder folder;
  const std::string mesh = folder.file("mesh.obj"), own = folder.file("own.svg");
  ASSERT_EQ(run_limn({"export", "tilted_torus", "--level", "3", "-o", mesh}).exit_code, 0);
  const auto judged_with = [&](const std::string& input, const std::vector<std::string>& more) {
    std::vector<std::string> call = {"judge",        own, "--against",   input, "--lines",         "contour,rim",
                                     "--max-missed", "0", "--max-false", "0",   "--max-displaced", "0.01"};
    call.insert(call.end(), more.begin(), more.end());
    return run_limn(call).exit_code;
  };
  ASSERT_EQ(run_limn({"contours", mesh, "--smooth", "--lines", "contour,rim", "-o", own}).exit_code, 0);
  EXPECT_EQ(judged_with(mesh, {"--smooth"}), 0);
  EXPECT_EQ(judged_with(mesh, {}), 1);
  ASSERT_EQ(run_limn({"contours", "tilted_torus", "--lines", "contour,rim", "--threshold", "0.5", "-o", own}).exit_code, 0);
  EXPECT_EQ(judged_with("tilted_torus", {"--threshold", "0.5"}), 0);
  EXPECT_EQ(judged_with("tilted_torus", {}), 1);
}

TEST(JudgeCommand, RefusesWhatItCannotCompare) {
  const TemporaryFolder folder;
  const std::string own = folder.write("own.svg", torus().svg);
  const auto refused = [](const RunResult& result, const std::string& hint) {
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_EQ(result.err_lines(), 1) << result.err;
    EXPECT_NE(result.err.find(hint), std::string::npos) << result.err;
  };
  refused(run_limn({"judge", own, "--against", "tilted_torus", "--size", "320x180"}), "viewBox");
  refused(run_limn({"judge", own, "--against", "tilted_torus", "--max-missed", "some"}), "--max-missed");
  refused(run_limn({"judge", own, "--against", "tilted_torus", "--alpha"}), "--alpha");
  refused(run_limn({"judge", own, "--against", "tilted_torus", "--smooth"}), "--smooth");
  refused(run_limn({"judge", own}), "--against");
  refused(run_limn({"judge", folder.file("none.svg"), "--against", "tilted_torus"}), "none.svg");
  refused(run_limn({"judge", folder.write("a.txt", "x"), "--against", "tilted_torus"}), ".txt");
}

}  // namespace
}  // namespace limn
