#include "raymarch/scene.h"
