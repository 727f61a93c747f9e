#include "subdiv/mesh.h"
