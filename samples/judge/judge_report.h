#pragma once
// A judgement as people and programs read it.

#include <optional>
#include <string>

#include "raymarch/lines.h"
#include "samples/judge/judge_lines.h"
#include "samples/output/output.h"

namespace limn {

/// A length, in pixels or as a share of all.
struct LengthLimit {
  double value = 0.0;  ///< px, or percent.
  bool percent = false;
};
/// "5px", "5" or "1%".
LengthLimit parse_length_limit(const std::string& field, const std::string& text);
/// "5 px" or "1 %".
std::string text_of(const LengthLimit& limit);

/// Beyond which a drawing fails.
struct JudgeLimits {
  std::optional<LengthLimit> missed{};     ///< Shares: of the visible lines.
  std::optional<LengthLimit> false_ink{};  ///< Shares of this and the others: of the drawing.
  std::optional<LengthLimit> hidden{};
  std::optional<LengthLimit> doubled{};
  std::optional<double> displaced_px{};  ///< 95 % lie within.
};

/// A limit, and what was measured.
struct LimitResult {
  std::string name{};      ///< "missed".
  std::string limit{};     ///< "1 %".
  std::string measured{};  ///< "2.3 % (31.2 px)".
  bool passed = true;
};
std::vector<LimitResult> check_judge_limits(const Judgement& judgement, const JudgeLimits& limits);

/// What was judged.
struct JudgeSubject {
  std::string drawing{};  ///< As given.
  std::string against{};
  int width_px = 0, height_px = 0;
  JudgeSettings settings{};
};

struct JudgeReport {
  const JudgeSubject& subject;
  const ViewGraph& graph;
  const DrawnLines& drawing;
  const Judgement& judgement;
  const std::vector<LimitResult>& limits;
};

/// "missed: contour, 12.3 px at 310.2, 88.1".
std::string text_of(const JudgeFinding& finding);
/// "shifted by 0.100 px (0.060 right, 0.080 down), standard error 0.001 px"; empty where it is not significant.
std::string text_of(const DrawingShift& shift);

std::string judge_text(const JudgeReport& report);
Json judge_json(const JudgeReport& report);
/// One test case a limit, failed where it is exceeded.
std::string judge_junit(const JudgeReport& report);
/// The whole page, without requests to anywhere.
std::string judge_page(const JudgeReport& report);

}  // namespace limn
