// toml++'s parser, compiled once and here: Debian's library has the fault that samples/toml_reader.h takes out.
#define TOML_IMPLEMENTATION
#include "samples/toml_reader.h"
