#include "samples/stability/case_context.h"

#include <fmt/format.h>

#include "sdf/simd.h"
// clang-format off: which targets, before the header that asks.
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "raymarch/audit.h"
#include "samples/experiment/job.h"
#include "samples/experiment/thread_settings.h"
#include "samples/input/scene_facts.h"

namespace limn {
namespace {

// What a case does not say: enough to see what breaks, and quick.
constexpr int kVoxels = 64;
constexpr int kLevel = 3;

/// The narrowest SIMD target that the program was compiled for, as long as it lives.
class SimdChoice {
 public:
  explicit SimdChoice(bool least) : least_(least) {
    if (!least_) return;
    std::int64_t slowest = hwy::SupportedTargets() & HWY_TARGETS;
    while ((slowest & (slowest - 1)) != 0) slowest &= slowest - 1;
    hwy::GetChosenTarget().Update(slowest);
  }
  ~SimdChoice() {
    if (least_) hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
  SimdChoice(const SimdChoice&) = delete;
  SimdChoice& operator=(const SimdChoice&) = delete;

 private:
  bool least_;
};

void change_mesh(const StabilityVariant& variant, Mesh& mesh) {
  std::vector<std::vector<std::int32_t>> faces;
  std::int32_t first = 0;
  for (const std::int32_t size : mesh.face_sizes) {
    const auto begin = mesh.corner_vertices.begin() + first;
    faces.emplace_back(begin, begin + size);
    // The first corner stays: fans start there.
    if (variant.turned) std::reverse(faces.back().begin() + 1, faces.back().end());
    first += size;
  }
  if (variant.reversed) {
    std::reverse(faces.begin(), faces.end());
    std::reverse(mesh.face_sizes.begin(), mesh.face_sizes.end());
  }
  mesh.corner_vertices.clear();
  mesh.corner_normals.clear();  // Of corners in another order.
  for (const auto& face : faces) mesh.corner_vertices.insert(mesh.corner_vertices.end(), face.begin(), face.end());
}

void move_scene(const StabilityVariant& variant, Scene& scene) {
  const Affine placed{glm::dmat3(variant.scale), variant.translate};
  for (SceneObject& object : scene.objects) {
    if (auto* field = std::get_if<Field>(&object.source)) {
      if (variant.scale != 1.0) *field = scale(*field, variant.scale);
      if (variant.translate != glm::dvec3(0.0)) *field = translate(*field, variant.translate);
      continue;
    }
    const bool bare = object.world_from_object.linear == glm::dmat3(1.0) && object.world_from_object.translation == glm::dvec3(0.0);
    auto* mesh = std::get_if<MeshSource>(&object.source);
    if (mesh != nullptr && bare) {
      // In the file itself, where it is hardest.
      Mesh moved = mesh->mesh;
      for (glm::dvec3& position : moved.positions) position = placed.point(position);
      mesh->mesh = std::move(moved);
    } else {
      object.world_from_object = compose(placed, object.world_from_object);
    }
  }
  CameraSettings& camera = scene.camera;
  if (camera.eye) camera.eye = placed.point(*camera.eye);
  if (camera.target) camera.target = placed.point(*camera.target);
  if (camera.ortho_height) camera.ortho_height = *camera.ortho_height * variant.scale;
}

ExecutionSettings how_of(const StabilityVariant& variant, ExecutionSettings how) {
  if (variant.threads > 0) how.threads = variant.threads;
  how.tile_px = variant.tile_px;
  return how;
}

}  // namespace

CaseContext::CaseContext(const StabilityCase& one, int draw, std::uint64_t seed, std::string surface, const ExecutionSettings& how)
    : case_(one), draw_(draw), seed_(seed), surface_(std::move(surface)), how_(how), values_(drawn_parameters(one, seed, draw)) {
  // Uniform over all rotations (Shoemake 1992).
  StabilityRandom turn(one.text.name + " views", seed, draw);
  const double u = turn.next(), a = 2.0 * std::numbers::pi * turn.next(), b = 2.0 * std::numbers::pi * turn.next();
  turn_ = glm::mat3_cast(glm::dquat(std::sqrt(u) * std::cos(b), std::sqrt(1.0 - u) * std::sin(a), std::sqrt(1.0 - u) * std::cos(a),
                                    std::sqrt(u) * std::sin(b)));
  stages_.resize(one.variants.size() + 1);
  views_.resize(one.variants.size() + 1);
}

StabilityStage CaseContext::make_stage(const StabilityVariant& variant) const {
  std::map<std::string, double> values = values_;
  for (const auto& [name, value] : variant.set) values[name] = value;
  StabilityStage stage;
  stage.variant = variant;
  stage.made = scene_of_case(case_, values);
  SceneInput& input = stage.made.input;
  for (SceneObject& object : input.scene.objects) {
    auto* source = std::get_if<MeshSource>(&object.source);
    if (source == nullptr || (!variant.turned && !variant.reversed)) continue;
    Mesh changed = source->mesh;
    change_mesh(variant, changed);
    *source = mesh_source(std::move(changed), source->scheme, source->file);
  }
  move_scene(variant, input.scene);
  stage.settings = surface_settings({}, input);
  stage.settings.kind = surface_;
  if (!input.surface.voxels && !input.surface.voxel_size) stage.settings.voxels = kVoxels;
  if (!input.surface.level) stage.settings.level = kLevel;
  stage.settings.voxel_size *= variant.scale;
  stage.scene = input.scene;
  for (const SceneObject& object : stage.scene.objects) {
    for (Finding& finding : audit(object, {.surface = stage.settings})) stage.findings.push_back(std::move(finding));
  }
  const ThreadLimit threads(variant.threads);
  const SimdChoice simd(variant.least_simd);
  stage.model = build_model(stage.scene, stage.settings);
  stage.warnings = total(stage.model).warnings;
  return stage;
}

std::vector<StabilityView> CaseContext::make_views(const StabilityStage& stage) const {
  const SimdChoice simd(stage.variant.least_simd);
  std::vector<StabilityView> views;
  for (const glm::ivec2 size : case_.sizes_px) {
    for (int i = 0; i < case_.views; ++i) {
      CameraSettings settings = stage.scene.camera;
      settings.width_px = size.x;
      settings.height_px = size.y;
      if (case_.views > 1) {
        settings.eye.reset();
        settings.direction = turn_ * view_direction(i, case_.views);
      }
      StabilityView view;
      view.camera = resolve_camera(settings, bounds(stage.scene));
      view.seen = render_gbuffer(stage.model, view.camera, how_of(stage.variant, how_));
      view.words = fmt::format("{}{}x{}", case_.views > 1 ? fmt::format("view {} of {}, ", i + 1, case_.views) : "", size.x, size.y);
      views.push_back(std::move(view));
    }
  }
  return views;
}

const StabilityStage& CaseContext::stage(size_t variant) {
  if (!stages_[variant])
    stages_[variant] = std::make_unique<StabilityStage>(make_stage(variant == 0 ? StabilityVariant{} : case_.variants[variant - 1]));
  return *stages_[variant];
}

const std::vector<StabilityView>& CaseContext::views(size_t variant) {
  if (!views_[variant]) views_[variant] = std::make_unique<std::vector<StabilityView>>(make_views(stage(variant)));
  return *views_[variant];
}

const CaseContext::Swept& CaseContext::swept(double value) {
  const auto found = swept_.find(value);
  if (found != swept_.end()) return found->second;
  StabilityVariant variant;
  variant.set["sweep"] = value;
  Swept made{make_stage(variant), {}};
  made.views = make_views(made.stage);
  return swept_.emplace(value, std::move(made)).first->second;
}

const std::vector<StabilityView>& CaseContext::fine_views(int times) {
  const auto found = fine_views_.find(times);
  if (found != fine_views_.end()) return found->second;
  const StabilityStage& drawn = stage();
  const bool formulas = why_not(find_surface("analytic"), drawn.scene).empty();
  SurfaceSettings settings = drawn.settings;
  settings.kind = "analytic";
  const SceneModel exact = formulas ? build_model(drawn.scene, settings) : SceneModel{};
  std::vector<StabilityView> fine;
  for (const StabilityView& view : views()) {
    fine.push_back({view.camera, {}, view.words});
    Camera& camera = fine.back().camera;
    camera.width_px *= times, camera.height_px *= times;
    camera.focal_px *= times, camera.pixels_per_unit *= times;
    fine.back().seen = render_gbuffer(formulas ? exact : drawn.model, camera, how_);
  }
  return fine_views_.emplace(times, std::move(fine)).first->second;
}

const std::string& CaseContext::unsupported() {
  if (!unsupported_) unsupported_ = why_not(find_surface(surface_), scene_of_case(case_, values_).input.scene);
  return *unsupported_;
}

const Scene& CaseContext::truth_scene() {
  const StabilityStage& base = stage();
  return base.made.reference.objects.empty() ? base.scene : base.made.reference;
}

Field CaseContext::truth_field() {
  std::vector<Field> fields;
  for (const SceneObject& object : truth_scene().objects) {
    const auto* field = std::get_if<Field>(&object.source);
    if (field == nullptr) throw InputError({case_.file, "object", "", "no field to compare with", "shapes, or a [[reference]] of shapes"});
    fields.push_back(*field);
  }
  return combine(Csg::union_, fields);
}

std::vector<MethodCall> CaseContext::methods() {
  BorderSpec spec;
  for (const std::string& name : case_.methods) {
    if (name != "all") spec.methods.push_back(name);
    if (name != "all") continue;
    for (const std::string& each : border_methods().names()) {
      if (std::find(case_.without.begin(), case_.without.end(), each) == case_.without.end()) spec.methods.push_back(each);
    }
  }
  std::vector<MethodCall> calls;
  if (!spec.methods.empty()) calls = method_calls(spec, {});
  // A scene that is refused whole may still name what it is about: it is looked at only for what it adds.
  if (!spec.methods.empty() && !case_.has_borders) return calls;
  for (MethodCall& call : method_calls({}, scene_of_case(case_, values_).input)) calls.push_back(std::move(call));
  return calls;
}

Border draw_border(const StabilityStage& stage, const StabilityView& view, const MethodCall& method) {
  const SimdChoice simd(stage.variant.least_simd);
  return method.method->draw({view.seen, view.camera, stage.model, stage.scene}, method.parameters);
}

Image<glm::vec4> picture_of(const StabilityStage& stage, const StabilityView& view, const Border* border) {
  Image<glm::vec4> picture = shade_headlight({view.seen, view.camera, stage.model, stage.scene});
  if (border != nullptr) lay_ink(picture, *border);
  return picture;
}

std::vector<std::string> said_of(const StabilityStage& stage, const std::string& method) {
  std::vector<std::string> said = stage.warnings;
  const std::vector<std::string> surfaces{stage.settings.kind}, methods{method};
  for (const Finding& finding : stage.findings) {
    if (matters(finding, surfaces, methods)) add_said({"audit: " + finding.message}, said);
  }
  return said;
}

void add_said(const std::vector<std::string>& more, std::vector<std::string>& said) {
  for (const std::string& sentence : more) {
    if (std::find(said.begin(), said.end(), sentence) == said.end()) said.push_back(sentence);
  }
}

}  // namespace limn
