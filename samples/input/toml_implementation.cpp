// toml++'s parser, compiled once and here: Debian's library has the fault that samples/input/toml_reader.h takes out.
#define TOML_IMPLEMENTATION
#include "samples/input/toml_reader.h"
