// What scene files and the rows of studies hold.

#include "samples/reference/reference.h"
#include "samples/spec/surface_setting.h"

namespace limn {
namespace {

/// Without the settings of [surface], which follow its kind.
constexpr DocumentedKey kSceneKeys[] = {
    {"camera", "eye", "world", "where the camera stands, [x, y, z]; missing: framed"},
    {"camera", "target", "world", "what it looks at; missing: the middle of the scene"},
    {"camera", "up", "world", "which way is up in the picture; default [0, 1, 0]"},
    {"camera", "fov", "degrees", "vertical field of view, above 0 and below 180; default 35"},
    {"camera", "ortho", "world", "height of the picture of a parallel projection; instead of fov"},
    {"camera", "azimuth", "degrees", "looks from so far round `up`: 0 from the front, 90 from the right; instead of eye; default 38.7"},
    {"camera", "elevation", "degrees", "looks from so far above the horizon, -90 to 90; instead of eye; default 25.1"},
    {"camera", "size", "px", "[width, height], 1 to 16384; default [1280, 720]"},
    {"surface", "kind", "", "representation: a name of `limn list surfaces`; missing: each object's own"},
    {"border", "method", "", "a name of `limn list methods`; its parameters stand beside it; [[border]] for several; default rim"},
    {"object", "name", "", "for messages, layers and exports"},
    {"object", "color", "", "linear RGB, 0 to 1; default [0.8, 0.8, 0.8]; in `of`: of that part, default the object's"},
    {"object", "material", "",
     "an id, 0 to 1000000, for the layer `material`, for lines between materials and for group = material; default 0; in `of`: of that "
     "part, "
     "default the object's"},
    {"object", "shape", "", "a name of `limn list shapes`; its parameters stand beside it"},
    {"object", "csg", "", "union, intersection or difference of the fields in `of`"},
    {"object", "of", "", "the fields of csg: tables with shape, csg or vm"},
    {"object", "smooth", "world", "radius of the blend of csg; default 0, sharp"},
    {"object", "vm", "", "a .vm file beside the scene file"},
    {"object", "grow", "world", "moves the surface of a field outwards"},
    {"object", "shell", "world", "makes a field a shell of this thickness"},
    {"object", "mesh", "", "a mesh file beside the scene file"},
    {"object", "scheme", "", "makes the mesh a cage: catmark, loop or bilinear"},
    {"object", "level", "", "of the mesh as a cage, 0 to 8"},
    {"object", "smooth_angle", "degrees", "as in [surface], for this mesh"},
    {"object", "vdb", "", "a volume beside the scene file"},
    {"object", "grid", "", "of the volume; missing: the only one"},
    {"object", "scale", "", "a number, or [x, y, z]; negative ones mirror"},
    {"object", "rotate", "degrees", "[axis x, axis y, axis z, angle], after scale"},
    {"object", "translate", "world", "[x, y, z], after rotate"},
};

/// Without the settings of surfaces, which follow `surface`.
constexpr DocumentedKey kRowColumns[] = {
    {"", "key", "", "of the cell (one model, view and method): a hash of all that determines it, the program's version included"},
    {"", "scene", "", "name of the input"},
    {"", "view", "", "number of the view, from 0"},
    {"", "width_px", "px", "width of the picture"},
    {"", "height_px", "px", "height of the picture"},
    {"", "surface", "", "representation; what it was made with follows, empty where the study does not vary it"},
    {"", "method", "", "outline method; its parameters are the last columns, `METHOD.PARAMETER`, empty in rows of other methods"},
    {"", "threshold", "", "N.V where its ink ends, and truth's with it; empty where its ink has no border that truth knows"},
    {"", "metric", "", "name of the value; the metrics above say what each is"},
    {"", "value", "unit", "the measurement; empty where the cell failed"},
    {"", "unit", "", "of the value: px, deg, or empty for a share, a ratio or a count"},
    {"", "floor", "unit",
     "the same measurement of the reference itself: a smaller value cannot be told from it; empty where the metric compares with the "
     "reference's picture"},
    {"", "truth", "", "what the true border was solved on; empty where there is none"},
    {"", "truth_exact", "", "true, or false where a proxy stands in for the surface that was meant"},
    {"", "truth_bound_px", "px", "how far off the true border itself may be; inf where that is not known"},
    {"", "resolution", "", "mean edge or voxel of the model, as a share of the scene's longest side"},
    {"", "time_ms", "ms", "build_ms + trace_ms + border_ms"},
    {"", "time_low_ms", "ms", "the same of the least times"},
    {"", "time_high_ms", "ms", "the same of the largest times"},
    {"", "build_ms", "ms", "making the model: the median of up to 3 times, as long as these take less than a tenth of a second"},
    {"", "build_low_ms", "ms", "the least of these times"},
    {"", "build_high_ms", "ms", "the largest of these times"},
    {"", "trace_ms", "ms", "tracing its picture, a ray a pixel: the median of up to 3 times"},
    {"", "trace_low_ms", "ms", "the least of these times"},
    {"", "trace_high_ms", "ms", "the largest of these times"},
    {"", "border_ms", "ms", "drawing the border, once"},
    {"", "bytes", "bytes", "memory that the model holds"},
    {"", "failed", "", "why there is no value; empty where there is one"},
};

}  // namespace

std::span<const DocumentedKey> scene_keys() {
  static const std::vector<DocumentedKey> all = [] {
    std::vector<DocumentedKey> keys;
    for (const DocumentedKey& key : kSceneKeys) {
      keys.push_back(key);
      if (key.where != "surface") continue;
      for (const SurfaceSetting& setting : surface_setting_list()) keys.push_back({"surface", setting.name, setting.unit, setting.help});
    }
    return keys;
  }();
  return all;
}
std::span<const DocumentedKey> row_columns() {
  static const std::vector<DocumentedKey> all = [] {
    std::vector<DocumentedKey> columns;
    for (const DocumentedKey& column : kRowColumns) {
      columns.push_back(column);
      if (column.key != "surface") continue;
      for (const SurfaceSetting& setting : surface_setting_list()) columns.push_back({"", setting.name, setting.unit, setting.help});
      columns.push_back({"", "local", "px", "tolerance of a local model, which is made for all views of the study"});
    }
    return columns;
  }();
  return all;
}

}  // namespace limn
