#include "samples/study/journal.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <span>
#include <sstream>
#include <system_error>

#include "sdf/error.h"
#include "sdf/output_file.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kBetweenSyncs{1};

fs::path journal_file(const fs::path& folder) { return folder / "rows.jsonl"; }
fs::path table_file(const fs::path& folder) { return folder / "rows.csv"; }

[[noreturn]] void fail(const fs::path& file) {
  throw MachineError(file.string() + ": writing failed: " + std::generic_category().message(errno));
}

void write_all(int handle, const std::string& bytes, const fs::path& file) {
  for (size_t written = 0; written < bytes.size();) {
    const ssize_t count = ::write(handle, bytes.data() + written, bytes.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail(file);
    written += static_cast<size_t>(count);
  }
}

/// Lines of the journal and of the table.
struct RowTexts {
  std::string json{}, csv{};
};

RowTexts texts_of(std::span<const StudyRow> rows, const std::vector<std::string>& parameters) {
  RowTexts texts;
  for (const StudyRow& row : rows) {
    texts.json += json_line(row) + "\n";
    texts.csv += csv_line(row, parameters) + "\n";
  }
  return texts;
}

void append_all(const std::vector<RowTexts>& parts, RowTexts& to) {
  for (const RowTexts& part : parts) {
    to.json += part.json;
    to.csv += part.csv;
  }
}

int open_end(const fs::path& file) {
  const int handle = ::open(file.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
  if (handle < 0) fail(file);
  return handle;
}

}  // namespace

bool failed(const std::vector<StudyRow>& cell) { return cell.size() == 1 && !cell.front().failed.empty(); }

Journal parse_journal(std::string_view text, const fs::path& file) {
  Journal journal;
  int line_number = 0;
  for (size_t at = 0, end; (end = text.find('\n', at)) != std::string_view::npos; at = end + 1) {
    StudyRow row = row_from_json(std::string(text.substr(at, end - at)), file, ++line_number);
    journal.last_key = row.key;
    journal.cells[journal.last_key].push_back(std::move(row));
  }
  return journal;
}

CellRows read_cells(const fs::path& folder) {
  std::ifstream stream(journal_file(folder), std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  auto [cells, last] = parse_journal(text.str(), journal_file(folder));
  // A failed cell is one line, and so never torn.
  if (last.empty() || failed(cells[last])) return cells;
  std::error_code ignored;
  if (!fs::exists(thumbnail_file(folder, last), ignored)) cells.erase(last);
  return cells;
}

void write_cells(const CellRows& cells, const std::vector<std::string>& keys, const std::vector<std::string>& parameters,
                 const fs::path& folder) {
  std::vector<const std::vector<StudyRow>*> known;
  for (const std::string& key : keys)
    if (const auto found = cells.find(key); found != cells.end()) known.push_back(&found->second);
  std::vector<RowTexts> texts(known.size());
  parallel_each(known.size(), [&](size_t k) { texts[k] = texts_of(*known[k], parameters); });
  RowTexts all{{}, csv_header(parameters) + "\n"};
  append_all(texts, all);
  write_whole(journal_file(folder), all.json);
  write_whole(table_file(folder), all.csv);
}

StudyJournal::StudyJournal(const fs::path& folder, std::vector<std::string> parameters)
    : folder_(folder), parameters_(std::move(parameters)), jsonl_(open_end(journal_file(folder))), csv_(open_end(table_file(folder))) {}

StudyJournal::~StudyJournal() {
  if (jsonl_ >= 0) ::close(jsonl_);
  if (csv_ >= 0) ::close(csv_);
}

void StudyJournal::append(const std::vector<StudyRow>& cell) {
  constexpr size_t kTogether = 16;
  std::vector<RowTexts> texts((cell.size() + kTogether - 1) / kTogether);
  // While one cell after the other is told of, nothing else is done.
  parallel_each(texts.size(), [&](size_t k) {
    const std::span<const StudyRow> rest = std::span(cell).subspan(k * kTogether);
    texts[k] = texts_of(rest.first(std::min(kTogether, rest.size())), parameters_);
  });
  RowTexts all;
  append_all(texts, all);
  write_all(jsonl_, all.json, journal_file(folder_));
  write_all(csv_, all.csv, table_file(folder_));
  // Only a machine that stops loses what is not on the disk; waiting for the disk takes longer than measuring a small cell.
  if (const auto now = std::chrono::steady_clock::now(); now - synced_ >= kBetweenSyncs) {
    if (::fdatasync(jsonl_) != 0 && errno != EINVAL) fail(journal_file(folder_));
    synced_ = now;
  }
}

}  // namespace limn
