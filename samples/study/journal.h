#pragma once
// The rows of a study as they come: rows.jsonl is the journal, rows.csv follows it. Whatever stops the program, even SIGKILL in the middle
// of a write, what is there afterwards is whole cells and at most one torn one at the end, which is cut away.

#include <chrono>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "samples/study/row.h"

namespace limn {

/// Rows of cells by key.
using CellRows = std::map<std::string, std::vector<StudyRow>>;

/// True where a cell has nothing but a reason.
bool failed(const std::vector<StudyRow>& cell);

/// What a journal holds.
struct Journal {
  CellRows cells{};        ///< By key.
  std::string last_key{};  ///< Of the last whole line; empty where there is none.
};
/// A journal's text as cells; what follows the end of the last line is passed over. `file` goes into messages. Throws InputError for lines
/// that are no rows.
Journal parse_journal(std::string_view text, const std::filesystem::path& file);

/// The whole cells of a folder's journal; a last cell that may be torn is left out: one that ended in the middle of a line, or that has not
/// got its thumbnail, which is written after its rows. Empty where there is no journal. Throws InputError for lines that are no rows.
CellRows read_cells(const std::filesystem::path& folder);

/// Both files anew, whole, in the order of `keys`; cells that are not in `cells` are passed over. `parameters`: StudyHead::parameters.
void write_cells(const CellRows& cells, const std::vector<std::string>& keys, const std::vector<std::string>& parameters,
                 const std::filesystem::path& folder);

/// Appends cells, each in one write: whole when the call returns, whatever stops the program. Where the machine stops, cells of the last
/// second or of the last call may be lost. Throws MachineError where the disk fails.
class StudyJournal {
 public:
  /// Opens both files of the folder at their ends. `parameters`: StudyHead::parameters.
  StudyJournal(const std::filesystem::path& folder, std::vector<std::string> parameters);
  /// Closes both files.
  ~StudyJournal();
  StudyJournal(const StudyJournal&) = delete;
  StudyJournal& operator=(const StudyJournal&) = delete;
  /// All rows of one cell.
  void append(const std::vector<StudyRow>& cell);

 private:
  std::filesystem::path folder_;
  std::vector<std::string> parameters_;
  int jsonl_ = -1, csv_ = -1;
  std::chrono::steady_clock::time_point synced_ = std::chrono::steady_clock::now();
};

}  // namespace limn
