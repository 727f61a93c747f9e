// The looks by name. A new one is a file of this folder that defines NAME_look(), and one line here.

#include "raymarch/look.h"

#define LIMN_LOOKS(X) \
  X(toon)             \
  X(ink)              \
  X(technical)        \
  X(clay)             \
  X(paper)

namespace limn {

#define LIMN_DECLARE(name) Look name##_look();
LIMN_LOOKS(LIMN_DECLARE)
#undef LIMN_DECLARE

const Registry<Look>& looks() {
#define LIMN_ENTRY(name) name##_look(),
  static const Registry<Look> all("look", {LIMN_LOOKS(LIMN_ENTRY)});
#undef LIMN_ENTRY
  return all;
}

}  // namespace limn
