#pragma once
// What a study found, in sentences with its numbers; nothing is said of what was not measured.

#include "samples/study/report_points.h"

namespace limn {

/// The first few say what was done and which model to take; the others go into details. At least one.
std::vector<std::string> study_sentences(const StudyHead& head, const ReportData& data);

/// The cheapest model whose median error is right to `tolerance`; nothing where none is. Of those that may be as quick as the quickest, by
/// the spread of their times, the one that needs least memory.
const ModelPoint* cheapest_within(const std::vector<ModelPoint>& points, double tolerance, const ErrorFloor& floor, Cost cost);

/// Of the right ones those that may be the quickest, by the spread of their times, in the order of `points`.
std::vector<const ModelPoint*> may_be_quickest(const std::vector<ModelPoint>& points, double tolerance, const ErrorFloor& floor);

}  // namespace limn
