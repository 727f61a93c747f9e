#pragma once
// What checks share: the worst of all views, kept with its picture.

#include <fmt/format.h>

#include "samples/stability/checks/check.h"

namespace limn {

/// What a check finds where the picture holds nothing that it measures: beyond every bound.
constexpr double kNothingSeen = 1e6;

class Worst {
 public:
  /// A number that was found in a view; the first and the largest stay, with their words and picture.
  void see(double number, const std::string& words, const StabilityStage& stage, const StabilityView& view,
           const Border* border = nullptr) {
    if (border != nullptr) add_said(border->notes, finding_.said);
    if (any_ && !(number > finding_.number)) return;
    any_ = true;
    finding_.number = number;
    finding_.message = view.words + ": " + words;
    finding_.picture = picture_of(stage, view, border);
  }
  void said(const std::vector<std::string>& more) { add_said(more, finding_.said); }
  StabilityFinding take() { return std::move(finding_); }

 private:
  StabilityFinding finding_{};
  bool any_ = false;
};

inline Parameter stability_number(const std::string& name, double value, const std::string& unit, const std::string& help) {
  return a_number(name, value).in(-1e12, 1e12).unit(unit).help(help);
}
inline Parameter stability_whole(const std::string& name, double value, double least, double most, const std::string& help) {
  return an_integer(name, value).in(least, most).help(help);
}

}  // namespace limn
