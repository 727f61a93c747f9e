// The classes of lines, in the order in which they are painted.

#include "raymarch/lines.h"

namespace limn {

const Registry<LineClassDescriptor>& line_classes() {
  static const Registry<LineClassDescriptor> all(
      "class of lines",
      {{{"suggestive", "radial curvature 0, growing towards the eye: contours of views nearby", "DeCarlo et al. 2003"},
        LineClass::suggestive,
        false},
       {{"ridge", "extremal curvature along its direction, where the surface bends outwards", "Ohtake et al. 2004"},
        LineClass::ridge,
        false},
       {{"valley", "extremal curvature along its direction, where the surface bends inwards", "Ohtake et al. 2004"},
        LineClass::valley,
        false},
       {{"crease", "two normals of one object meet at an angle", "DeCarlo et al. 2003"}, LineClass::crease, true},
       {{"intersection", "two objects pass through each other", "Grabli et al. 2010"}, LineClass::intersection, true},
       {{"material",
         "two materials meet: parts of a field, faces of a mesh; where objects of two pass through each other unless intersections are "
         "asked for, too",
         "Grabli et al. 2010"},
        LineClass::material,
        true},
       {{"rim", "N.V = threshold, the inner border of the rim", "limn"}, LineClass::rim, false},
       {{"boundary", "an open edge of a surface", "Grabli et al. 2010"}, LineClass::boundary, true},
       {{"contour", "N.V changes sign: the contour generator, split by occlusion; creases that are folds too", "Koenderink 1984"},
        LineClass::contour,
        true}});
  return all;
}

const std::string& name_of(LineClass line_class) {
  for (const LineClassDescriptor& one : line_classes()) {
    if (one.line_class == line_class) return one.about.name;
  }
  return line_classes()[0].about.name;
}

const char* name_of(VertexKind kind) {
  switch (kind) {
    case VertexKind::crossing:
      return "crossing";
    case VertexKind::cusp:
      return "cusp";
    case VertexKind::joint:
      return "joint";
    case VertexKind::frame:
      return "frame";
    case VertexKind::end:
      break;
  }
  return "end";
}

}  // namespace limn
