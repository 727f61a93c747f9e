#pragma once
// How far a drawing is from the lines of a view graph: what it lacks, what it adds, and how far the rest lies off.

#include <array>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "raymarch/lines.h"

namespace limn {

/// A stroke of the drawing, or one edge of wide ink.
struct InkLine {
  std::vector<glm::dvec2> points{};  ///< px of the picture; at least two.
  bool closed = false;               ///< The first point is not repeated at the end.
  double width_px = 0.0;             ///< 0 where it is an edge of an area.
};

/// A drawing, whatever file it was.
struct DrawnLines {
  int width_px = 0, height_px = 0;
  std::vector<InkLine> lines{};
  double resolution_px = 0.05;       ///< Lines that are nearer to each other cannot be told apart in it.
  double apart_px = 0.0;             ///< Nearer to another line than this, the place of a line cannot be measured in it: ink runs together.
  double ends_px = 0.3;              ///< How far its ends may lie before or behind those of the lines.
  std::string from{};                ///< "strokes", "lines of ink", "outlines of areas".
  std::vector<std::string> notes{};  ///< What was left out of it.
};

struct JudgeSettings {
  double search_px = 2.0;     ///< A line of the drawing farther off does not match. Above 0.
  double angle_deg = 35.0;    ///< Nor does one whose direction differs by more.
  double displaced_px = 0.5;  ///< What lies farther off is a finding.
  double least_px = 0.25;     ///< Shorter runs are no findings.
};

enum class FindingKind : std::uint8_t {
  missed,        ///< A visible line that the drawing lacks.
  false_stroke,  ///< The drawing has a stroke where no line is.
  hidden,        ///< A stroke along a line that the surface hides.
  doubled,       ///< More strokes than lines.
  displaced,     ///< A stroke lies farther off than JudgeSettings::displaced_px.
};
inline constexpr std::array<FindingKind, 5> kFindingKinds = {FindingKind::missed, FindingKind::false_stroke, FindingKind::hidden,
                                                             FindingKind::doubled, FindingKind::displaced};
/// As the summary has it: "hidden line shown".
const char* title_of(FindingKind kind);
/// As JSON has it: "hidden".
const char* key_of(FindingKind kind);

/// A stretch of one kind.
struct JudgeFinding {
  FindingKind kind = FindingKind::missed;
  std::optional<LineClass> line_class{};  ///< Unset: false strokes, which are of none.
  glm::dvec2 px{0.0};                     ///< In the middle of the stretch; of a displaced one the worst place.
  double length_px = 0.0;
  double distance_px = 0.0;  ///< Of a displaced one: at its worst place.
  bool gap = false;          ///< Of a missed one: the drawing has the line before and behind it.
  std::vector<glm::dvec2> points{};
};

/// Distances of matched lines, px. NaN where nothing matches.
struct Displacement {
  double mean = std::numeric_limits<double>::quiet_NaN();  ///< Signed, outwards positive; contours and boundaries alone.
  double rms = std::numeric_limits<double>::quiet_NaN();
  double p95 = std::numeric_limits<double>::quiet_NaN();
  double worst = std::numeric_limits<double>::quiet_NaN();
  glm::dvec2 worst_at{0.0};
};

/// Of one class, or over all.
struct JudgeRow {
  std::optional<LineClass> line_class{};  ///< Unset: over all.
  double line_px = 0.0;                   ///< Visible lines.
  double missed_px = 0.0;                 ///< Of them.
  double crowded_px = 0.0;  ///< Of them: nearer to another than DrawnLines::apart_px; only looked at for whether there is ink.
  double false_px = 0.0;    ///< Of the drawing; over all only.
  double hidden_px = 0.0;   ///< Of the drawing.
  double doubled_px = 0.0;  ///< Of the drawing.
  int chains = 0;           ///< Visible ones.
  int pieces = 0;           ///< Stretches of them that the drawing has.
  int gaps = 0;             ///< Between two of one chain.
  Displacement displacement{};
};

/// The translation that fits the matched lines best, by least squares.
struct DrawingShift {
  glm::dvec2 px{0.0};  ///< The drawing lies this far right and down.
  double size_px = 0.0;
  double error_px = std::numeric_limits<double>::infinity();  ///< Standard error of its size.
  bool significant = false;                                   ///< At least four standard errors, and more than the drawing's own precision.
};

/// Of the drawing's strokes, weighted by length; 0 where they have none.
struct InkWidth {
  double mean_px = 0.0, least_px = 0.0, most_px = 0.0;
};

struct Judgement {
  JudgeRow all{};
  std::vector<JudgeRow> classes{};  ///< Those that the picture has lines of, in the order of line_classes().
  double drawn_px = 0.0;            ///< Length of the drawing within the frame.
  int strokes = 0;                  ///< Pieces of the drawing within the frame.
  DrawingShift shift{};
  InkWidth width{};
  std::vector<JudgeFinding> findings{};  ///< By kind, the longest first.
};

/// Lengths are measured after a significant shift is taken out, displacements before. Throws InputError where the drawing has more than a
/// million pixels of line.
Judgement judge_lines(const ViewGraph& graph, const DrawnLines& drawing, const JudgeSettings& settings);

}  // namespace limn
