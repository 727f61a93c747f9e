#!/usr/bin/env python3
"""One name, one definition: no two files define a type, an inline function or an inline variable of the same name, but in unnamed namespaces.

A linker does not report it. Of functions that are made from the type, such as std::vector's, it keeps one for both: where they differ in size,
the elements of one of them are written past the end of what was allocated for the other's ([basic.def.odr]).

  one_definition.py FOLDER ...    # of sources; 1 where something is found
"""

import collections
import pathlib
import re
import sys

TYPE = re.compile(r"(?:template <.*> )?(?:struct|class|union|enum class|enum) (?:alignas\(.*?\) )?(\w+)(?: final)?(?: :[^:].*)? \{")
FUNCTION = re.compile(r"(?:template <.*> )?(?:\[\[nodiscard\]\] )?inline [^=]*?(\w+)\(([^)]*)")

VARIABLE = re.compile(r"inline (?:constexpr |const )+[^()=]*?(\w+)(?:\[.*\])?(?: =|\{|;|$)")


def parameters(text):
    """Their types, without their names."""
    return ", ".join(re.sub(r"\s*=.*", "", one).strip().rpartition(" ")[0] for one in text.split(","))


def definitions(path):
    """What other files see of types, inline functions and inline variables: their names with their namespaces."""
    spaces = []
    for line in path.read_text(encoding="utf-8").splitlines():
        if begins := re.match(r"(?:inline )?namespace ?([\w:]*) ?\{$", line):
            spaces.append(begins[1])
        elif line.startswith("}  // namespace") and spaces:
            spaces.pop()
        elif "" in spaces:
            continue
        elif found := TYPE.match(line):
            yield "::".join([*spaces, found[1]])
        elif found := VARIABLE.match(line):
            yield "::".join([*spaces, found[1]])
        elif found := FUNCTION.match(line):
            yield "::".join([*spaces, f"{found[1]}({parameters(found[2])})"])


def main():
    files = collections.defaultdict(set)
    for folder in map(pathlib.Path, sys.argv[1:]):
        for path in sorted(folder.rglob("*")):
            if path.suffix in (".h", ".cpp"):
                for name in definitions(path):
                    files[name].add(str(path))
    if not files:
        sys.exit(f"no definitions in {' '.join(sys.argv[1:])}: expected folders of sources")
    twice = {name: found for name, found in files.items() if len(found) > 1}
    for name, found in sorted(twice.items()):
        print(f"{name} is defined in {' and in '.join(sorted(found))}: give one of them another name", file=sys.stderr)
    sys.exit(1 if twice else 0)


if __name__ == "__main__":
    main()
