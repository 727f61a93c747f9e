#include "samples/study/study_summary.h"

#include "samples/study/report_words.h"

namespace limn {

std::vector<StudyRow> rows_in_order(const StudyFolder& folder) {
  std::vector<StudyRow> rows;
  for (const PlannedCell& cell : folder.record.cells) {
    const auto found = folder.rows.find(cell.key);
    if (found != folder.rows.end()) rows.insert(rows.end(), found->second.begin(), found->second.end());
  }
  return rows;
}

std::string summary_text(const StudyFolder& folder) {
  constexpr size_t kSentences = 4;
  const StudyHead& head = folder.record.head;
  const std::vector<std::string> sentences = study_sentences(head, collect_report(head, rows_in_order(folder)));
  std::string text;
  for (size_t i = 0; i < std::min(kSentences, sentences.size()); ++i) text += sentences[i] + "\n";
  return text;
}

}  // namespace limn
