#pragma once
// What an experiment is expected to take: known growth (faces by 4 a level, voxels by the square of the resolution, rays by pixels) with
// constants of a machine of 2023; what this machine makes of them is learnt as work is done.

#include <map>
#include <string>

#include "raymarch/surface.h"

namespace limn {

/// What something is expected to cost, the same on every machine: what the machine makes of it is for CostLedger to find out.
struct ExpectedCost {
  double build_ms = 0.0;   ///< Of the model.
  double trace_ms = 0.0;   ///< A picture.
  std::int64_t bytes = 0;  ///< Of the model.
};

/// Sizes from which the growth starts, counted once for a scene.
struct SceneSize {
  /// One object, in the scene's order.
  struct Object {
    double faces = 0.0;         ///< Of the cage or the mesh as loaded; of the tessellation's cage.
    bool refines = false;       ///< Levels multiply the faces.
    double area = 0.0;          ///< World.
    double longest_side = 0.0;  ///< World.
    bool is_field = false;      ///< Analytic.
    double parts = 1.0;         ///< Shapes that the field is put together from.
    double formula = 1.0;       ///< How long a part's formula takes on average, of an ellipsoid's as 1, roughly.
    double own_voxels = 0.0;    ///< Of a volume as loaded.
    bool has_holes = false;     ///< Of a mesh that may become a level set: edges of one face.
    std::string cannot_mesh{};  ///< Why no mesh of it can be made, where that was tried.
  };
  std::vector<Object> objects{};  ///< In the scene's order.
};
/// `with_cages`: fields' tessellations are counted by their cages, which takes as long as making them; otherwise their faces are 0 and
/// their area is counted on a lattice. `cache`: of build_model, which then starts from the cages that were made; may be null.
SceneSize size_of(const Scene& scene, const SurfaceSettings& settings, bool with_cages = true, ObjectMeshCache* cache = nullptr);

/// Of one model of the scene; `pixels` are those of a picture.
ExpectedCost expected_cost(const SceneSize& size, const SurfaceSettings& settings, double pixels);
/// What borders have to be looked for in, as faces of a field's cage: the richer the shape, the finer that is.
double border_faces(const SceneSize& size);
/// To solve the truth of one view and threshold; `faces` as border_faces() has them.
double truth_ms(double pixels, double faces);
/// To draw and measure one cell, the same.
double cell_ms(double pixels, double faces);
/// Faces that the objects which refine have at a level.
double faces_at_level(const SceneSize& size, int level);

/// Work still to be done, in expected milliseconds by kind of work, and how long work of that kind really took.
class CostLedger {
 public:
  /// Adds work that is still to be done.
  void plan(const std::string& kind, double expected_ms) { entries_[kind].left_ms += expected_ms; }
  /// A measurement that is no part of the plan.
  void learn(const std::string& kind, double expected_ms, double took_ms);
  /// Part of the plan is done.
  void done(const std::string& kind, double expected_ms, double took_ms);
  /// Part of the plan falls away.
  void drop(const std::string& kind, double expected_ms);
  /// Expected for the work still to be done, corrected by how long work of its kind, and of all kinds, took.
  double remaining_ms() const;
  double spent_ms() const;  ///< What the work that is done took.
  /// "truth 2.1 s (expected 1.8 s); …" of what was done.
  std::string text() const;

 private:
  struct Entry {
    double left_ms = 0.0, expected_ms = 0.0, took_ms = 0.0, spent_ms = 0.0;
  };
  std::map<std::string, Entry> entries_{};
};

}  // namespace limn
