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

/// One view as the scene has it and as a variant of the scene has it, each with the method's border.
struct VariantView {
  const StabilityStage& changed;
  const StabilityView &view, &other;
  const Border &border, &other_border;
};

/// Calls `look` with each variant's views, after what the method says of the variant was kept.
template <class Look>
void for_each_variant(CaseContext& context, const MethodCall& method, Worst& worst, const Look& look) {
  for (size_t variant = 1; variant <= context.which().variants.size(); ++variant) {
    const StabilityStage& changed = context.stage(variant);
    worst.said(said_of(changed, method.method->about.name));
    for (size_t k = 0; k < context.views().size(); ++k) {
      const StabilityView &view = context.views()[k], &other = context.views(variant)[k];
      const Border border = draw_border(context.stage(), view, method), other_border = draw_border(changed, other, method);
      look(VariantView{changed, view, other, border, other_border});
    }
  }
}

inline Parameter stability_number(const std::string& name, double value, const std::string& unit, const std::string& help) {
  return a_number(name, value).in(-1e12, 1e12).unit(unit).help(help);
}
inline Parameter stability_whole(const std::string& name, double value, double least, double most, const std::string& help) {
  return an_integer(name, value).in(least, most).help(help);
}

}  // namespace limn
