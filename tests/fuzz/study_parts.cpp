// Parts of a study, joined: study.json and rows.jsonl of each, one after the other, with a line "====" between any two texts.
#include <optional>

#include "samples/study/folder.h"
#include "samples/study/study_summary.h"
#include "tests/fuzz/fuzz_target.h"

namespace limn {
namespace {

constexpr std::string_view kBetween = "\n====\n";

std::string_view next_text(std::string_view& rest) {
  const size_t end = rest.find(kBetween);
  const std::string_view text = rest.substr(0, end);
  rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + kBetween.size());
  return text;
}

StudyFolder read_part(std::string_view& rest) {
  StudyRecord record = parse_record(next_text(rest), "study.json");
  // Its last line's end belongs to the journal.
  Journal journal = parse_journal(std::string(next_text(rest)) + "\n", "rows.jsonl");
  StudyFolder part{std::move(record), std::move(journal.cells)};
  check_planned(part, "rows.jsonl");
  return part;
}

void check_rows(const StudyFolder& merged) {
  int line = 0;
  for (const StudyRow& row : rows_in_order(merged)) {
    fuzz::require(csv_line(row, merged.record.head.parameters).find('\n') == std::string::npos, "a row of more than one line");
    fuzz::require(row_from_json(json_line(row), "again.jsonl", ++line).key == row.key, "a row that does not read back");
  }
}

void use(std::string_view rest) {
  std::optional<StudyFolder> merged;
  while (!rest.empty()) {
    StudyFolder part = read_part(rest);
    if (!merged) merged = StudyFolder{part.record, {}};
    if (!difference(merged->record, part.record).empty()) return;
    take_part(std::move(part), *merged);
  }
  if (!merged) return;
  missing_cells(*merged);
  check_rows(*merged);
  fuzz::require(!summary_text(*merged).empty(), "a study without a summary");
}

}  // namespace
}  // namespace limn

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  limn::fuzz::only_refused([&] { limn::use(limn::fuzz::text_of(data, size)); });
  return 0;
}
