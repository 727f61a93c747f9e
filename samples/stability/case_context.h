#pragma once
// What checks work with: a case's scene, modelled and seen, each model and picture made once however many methods look at it.

#include <map>
#include <memory>

#include "raymarch/audit.h"
#include "raymarch/picture.h"
#include "samples/stability/case.h"
#include "sdf/shape.h"

namespace limn {

/// A scene, modelled.
struct StabilityStage {
  StabilityScene made{};
  Scene scene{};
  SurfaceSettings settings{};
  SceneModel model{};
  std::vector<std::string> warnings{};  ///< Of the model.
  std::vector<Finding> findings{};      ///< Of the audit.
  StabilityVariant variant{};
};

/// A stage seen from somewhere.
struct StabilityView {
  Camera camera{};
  GBuffer seen{};
  std::string words{};  ///< "view 2 of 5, 160x120".
};

class CaseContext {
 public:
  CaseContext(const StabilityCase& one, int draw, std::uint64_t seed, std::string surface, const ExecutionSettings& how);

  const StabilityCase& which() const { return case_; }
  const std::string& surface() const { return surface_; }
  const std::map<std::string, double>& values() const { return values_; }
  const ExecutionSettings& how() const { return how_; }
  StabilityRandom random() const { return {case_.text.name + " check", seed_, draw_}; }

  /// 0: the scene itself; i: its variant i - 1. Throws InputError.
  const StabilityStage& stage(size_t variant = 0);
  const std::vector<StabilityView>& views(size_t variant = 0);
  /// The scene with another value for "$sweep", and its views.
  struct Swept {
    StabilityStage stage{};
    std::vector<StabilityView> views{};
  };
  const Swept& swept(double value);
  /// The views of the scene itself, each at `times` its size, drawn from formulas where they exist: what a coarse model cannot show.
  const std::vector<StabilityView>& fine_views(int times);
  /// What the scene is measured against: the [[reference]], else the scene as it is drawn.
  const Scene& truth_scene();
  /// Its objects as one field. Throws InputError where one of them is none.
  Field truth_field();

  /// Empty where the surface can model the scene, else why not.
  const std::string& unsupported();
  /// The methods that the case is about, resolved.
  std::vector<MethodCall> methods();

 private:
  StabilityStage make_stage(const StabilityVariant& variant) const;
  std::vector<StabilityView> make_views(const StabilityStage& stage) const;
  const StabilityCase& case_;
  int draw_;
  std::uint64_t seed_;
  std::string surface_;
  ExecutionSettings how_;
  std::map<std::string, double> values_;
  glm::dmat3 turn_{1.0};  ///< Of the directions of several views.
  std::vector<std::unique_ptr<StabilityStage>> stages_;
  std::vector<std::unique_ptr<std::vector<StabilityView>>> views_;
  std::map<double, Swept> swept_;
  std::map<int, std::vector<StabilityView>> fine_views_;
  std::optional<std::string> unsupported_;
};

/// What a method draws of a view.
Border draw_border(const StabilityStage& stage, const StabilityView& view, const MethodCall& method);
/// The view shaded, with ink over it.
Image<glm::vec4> picture_of(const StabilityStage& stage, const StabilityView& view, const Border* border = nullptr);
/// What model and audit say that bears on the surface and the method; each sentence of the audit starts with "audit: ".
std::vector<std::string> said_of(const StabilityStage& stage, const std::string& method);
/// Adds what is not there yet.
void add_said(const std::vector<std::string>& more, std::vector<std::string>& said);

}  // namespace limn
