#include "samples/output/output.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "samples/spec/flags.h"
#include "sdf/error.h"
#include "sdf/memory_text.h"

namespace limn {
namespace {

namespace fs = std::filesystem;

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

// The nearest folder above that exists decides whether the missing ones can be made.
void check_place(const fs::path& file) {
  fs::path folder = fs::absolute(file).parent_path();
  std::error_code ignored;
  while (!fs::exists(folder, ignored) && folder.has_relative_path()) folder = folder.parent_path();
  if (!fs::is_directory(folder, ignored)) {
    throw InputError({file.string(), "output", "", folder.string() + " is not a folder", "a path below a folder"});
  }
  if (access(folder.c_str(), W_OK | X_OK) != 0) {
    throw InputError({file.string(), "output", "", folder.string() + " cannot be written to", "a folder that you may write to"});
  }
}

}  // namespace

fs::path default_output(const std::string& command, const std::string& name) { return fs::path("limn-out") / command / name; }

std::string ending_of(const fs::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

void check_output_file(const fs::path& file, bool no_clobber, const std::vector<std::string>& endings) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) {
    throw InputError({file.string(), "output", "", "is a folder", "a file ending in one of " + joined(endings)});
  }
  if (std::find(endings.begin(), endings.end(), ending_of(file)) == endings.end()) {
    throw InputError({file.string(), "output", file.extension().string().empty() ? "no ending" : file.extension().string(),
                      "unknown kind of file", "one of " + joined(endings)});
  }
  if (no_clobber && fs::exists(file, ignored)) {
    throw InputError({file.string(), "no_clobber", "", "exists already; choose another name, or leave out no_clobber = true", ""});
  }
  check_place(file);
}

void check_output_folder(const fs::path& folder, bool no_clobber) {
  std::error_code ignored;
  if (fs::exists(folder, ignored) && !fs::is_directory(folder, ignored)) {
    throw InputError({folder.string(), "output", "", "is a file", "a folder"});
  }
  if (no_clobber && fs::exists(folder, ignored) && !fs::is_empty(folder, ignored)) {
    throw InputError(
        {folder.string(), "no_clobber", "", "exists already and is not empty; choose another name, or leave out no_clobber = true", ""});
  }
  check_place(folder / "file");
}

namespace {

/// Keys whose values are sentences; all other text is names, paths and calls, which stay as they are.
bool holds_sentences(const std::string& key) {
  for (const char* const name : {"warnings", "notes", "message", "remedy", "failed", "summary", "skipped"})
    if (key == name) return true;
  return false;
}

/// What a document says in sentences, as somebody at a command line needs it.
void put_flags_into(Json& value, bool sentences) {
  if (value.is_string() && sentences) value = in_flags(value.get<std::string>());
  if (value.is_array())
    for (Json& one : value) put_flags_into(one, sentences);
  if (value.is_object())
    for (auto& [key, one] : value.items()) put_flags_into(one, holds_sentences(key));
}

void write_to_stdout(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) throw MachineError("cannot write to standard output");
}

}  // namespace

void print_text(const std::string& text) { write_to_stdout(text); }

void print_json(Json document) {
  put_flags_into(document, false);
  write_to_stdout(document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

void print_note(const std::string& text) {
  std::string line = in_flags(text);
  // Names of objects and files may hold anything, a terminal's commands too.
  std::replace_if(
      line.begin(), line.end(), [](char c) { return (static_cast<unsigned char>(c) < ' ' && c != '\t') || c == '\x7f'; }, ' ');
  std::fprintf(stderr, "limn: %s\n", line.c_str());
}

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

std::string bytes_text(double bytes) { return memory_text(bytes); }

std::string time_text(double milliseconds) {
  if (milliseconds < 10.0) return fmt::format("{:.1f} ms", milliseconds);
  if (milliseconds < 1000.0) return fmt::format("{:.0f} ms", milliseconds);
  return fmt::format("{:.2f} s", milliseconds / 1e3);
}

}  // namespace limn
