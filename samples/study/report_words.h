#pragma once
// What a study found, in sentences with its numbers; nothing is said of what was not measured.

#include "samples/study/report_points.h"

namespace limn {

/// The first few say what was done and which model to take; the others go into details. At least one.
std::vector<std::string> study_sentences(const StudyHead& head, const ReportData& data);

/// The cheapest model in time whose median error is within `tolerance`; nothing where none is.
const ModelPoint* cheapest_within(const std::vector<ModelPoint>& points, double tolerance, Cost cost);

}  // namespace limn
