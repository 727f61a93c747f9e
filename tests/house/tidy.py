#!/usr/bin/env python3
"""clang-tidy over limn's own sources, each content once.

All of them take 40 minutes of one core, most of it in the headers of others. So tests/house/tidy.txt lists contents (SHA-256) that need not be
looked at: `clean`, clang-tidy found nothing in them, or `old`, they were there before the check. The test looks at the rest, and fails on
what clang-tidy finds; `./run tidy` does the same and then adds what is clean to the list. What a file includes does not count as its content:
a header is looked at through a source that includes it.

  tidy.py --build build/release            # looks at what is not in the list; 1 where something is found, 77 without clang-tidy
  tidy.py --build build/release --write    # ... and adds what is clean
  tidy.py --build build/release --old      # looks at the old contents, too
"""

import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
LIST = ROOT / "tests/house/tidy.txt"
FOLDERS = ("sdf", "subdiv", "raymarch", "samples")
SKIPPED = 77  # what CMake takes for a test that could not run


def content_hash(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def own_files(suffix):
    return sorted(path for folder in FOLDERS for path in (ROOT / folder).rglob("*" + suffix))


def settings_line():
    return "settings " + content_hash(ROOT / ".clang-tidy")


def read_list():
    """Word by hash, by these settings; what was clean by others counts as old."""
    if not LIST.exists():
        return {}
    first, *lines = LIST.read_text().split("\n")
    same = first == settings_line()
    return {line.split()[1]: line.split()[0] if same else "old" for line in lines if line}


def write_list(words):
    """Of the files as they are; what is gone goes from the list, too."""
    lines = [f"{words[content_hash(path)]} {content_hash(path)} {path.relative_to(ROOT)}"
             for path in own_files(".h") + own_files(".cpp") if content_hash(path) in words]
    LIST.write_text("\n".join([settings_line()] + lines) + "\n")


def included_by(headers, sources):
    """For each header the source to look at it through: that of its own name, or the first that includes it, itself or through others."""
    direct = {}
    for path in own_files(".h") + own_files(".cpp"):
        direct[path] = [ROOT / name for name in re.findall(r'^#include "([^"]+)"', path.read_text(), re.M)]

    def reaches(source):
        seen, open_ones = set(), [source]
        while open_ones:
            for header in direct.get(open_ones.pop(), []):
                if header not in seen:
                    seen.add(header)
                    open_ones.append(header)
        return seen

    chosen = {}
    wanted = set(headers)
    for source in sorted(sources, key=lambda s: len(direct[s])):
        for header in wanted & reaches(source):
            if header not in chosen or source.stem == header.stem:
                chosen[header] = source
    return chosen


def commands(build):
    """How each source is compiled, for clang: without GCC's precompiled headers."""
    kept = {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        entry["command"] = re.sub(r" -include \S*cmake_pch\.hxx| -Winvalid-pch", "", entry["command"])
        kept.setdefault(pathlib.Path(entry["file"]).resolve(), entry)
    return kept


def look(source, folder):
    """What clang-tidy finds in one source and its headers; None: nothing."""
    call = ["clang-tidy", "-p", str(folder), "--quiet", "--warnings-as-errors=*", str(source)]
    run = subprocess.run(call, capture_output=True, text=True)
    return run.stdout if run.returncode != 0 else None


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--build", type=pathlib.Path, required=True, help="a configured build folder")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="how many at a time")
    parser.add_argument("--write", action="store_true", help="add what is clean to tests/house/tidy.txt")
    parser.add_argument("--old", action="store_true", help="look at contents that were there before the check, too")
    options = parser.parse_args()
    if not shutil.which("clang-tidy"):
        print("skipped: no clang-tidy; the package clang-tidy brings it")
        return SKIPPED

    known = commands(options.build)
    folder = options.build / "tidy"
    folder.mkdir(exist_ok=True)
    (folder / "compile_commands.json").write_text(json.dumps(list(known.values())))

    words = read_list()
    passed = {content for content, word in words.items() if word == "clean" or not options.old}
    sources = [path for path in own_files(".cpp") if path in known]
    changed = {path for path in sources + own_files(".h") if content_hash(path) not in passed}
    through = included_by([path for path in changed if path.suffix == ".h"], sources)
    work = sorted({path for path in changed if path.suffix == ".cpp"} | set(through.values()))
    of_source = {source: [source] + [header for header, by in through.items() if by == source] for source in work}

    found = 0
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        looks = {pool.submit(look, source, folder): source for source in work}
        for number, done in enumerate(concurrent.futures.as_completed(looks), 1):
            source, text = looks[done], done.result()
            print(f"{number}/{len(work)} {source.relative_to(ROOT)}", flush=True)
            if text is not None:
                found += 1
                print(text, flush=True)
                continue
            words.update({content_hash(path): "clean" for path in of_source[source]})
            if options.write and (number % 20 == 0 or number == len(work)):
                write_list(words)
    if options.write:
        write_list(words)
    print(f"{len(work)} sources looked at, something found in {found}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
