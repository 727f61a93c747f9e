#!/usr/bin/env python3
"""Equal calls give equal bytes, however many threads work at them and however often they run: hashes every output of some calls, or of the
whole demo, with one thread, with two, and with two again.

determinism.py LIMN FOLDER [--demo] [--json FILE]

Measured times are the one thing that differs between equal runs. `compare --no-timings` leaves them out of sheet and page, and is what is
hashed here; a study's rows are compared without their times, and its charts, which draw them, are not.
"""
import argparse
import hashlib
import json
import pathlib
import shutil
import stat
import sys

import child

HERE = pathlib.Path(__file__).resolve().parent
RUNS = (("one thread", 1), ("two threads", 2), ("two threads again", 2))
CALLS = (
    ("render", "machined_part", "-o", "field.exr", "-o", "field.png", "-o", "field.jpg", "-o", "field.tif", "--size", "200x150", "--samples", "4"),
    ("render", "teacup", "-o", "mesh.exr", "--surface", "mesh", "--size", "200x150"),
    ("render", "gyroid", "-o", "level_set.exr", "--surface", "level_set", "--voxels", "96", "--gradient", "cubic", "--size", "200x150"),
    ("render", "rook", "-o", "both.tif", "--surface", "mesh_level_set", "--voxels", "64", "--method", "rim_width", "--size", "200x150"),
    ("compare", "ellipsoid", "-o", "compare", "--size", "160x120", "--voxels", "48"),
    ("export", "teacup", "-o", "teacup.obj", "--level", "2"),
    ("export", "rook", "-o", "rook.ply", "--level", "2"),
    ("export", "machined_part", "-o", "part.vdb", "--voxels", "64"),
    ("study", "ellipsoid", "-o", "study", "--levels", "0,1", "--voxels", "16", "--views", "2", "--size", "80x60"),
)


def threads_of(limn, folder, threads):
    """The program with a number of threads, as a program."""
    script = folder / f"limn-{threads}"
    script.write_text(f"""#!/bin/sh
case $1 in
  compare | demo) exec '{limn}' "$@" --threads {threads} --no-timings ;;
  render | export | study) exec '{limn}' "$@" --threads {threads} ;;
  *) exec '{limn}' "$@" ;;
esac
""")
    script.chmod(script.stat().st_mode | stat.S_IXUSR)
    return script


def run_calls(program, out, demo):
    if demo:
        child.must([program, "demo", "-o", out], seconds=3600)
        return
    out.mkdir()
    for call in CALLS:
        child.must([program, *call, "-q"], cwd=out)


def without_times(row):
    return {key: value for key, value in row.items() if not key.endswith("_ms")}


def hashes(out):
    """Name -> what must be equal of each file; None for what draws measured times."""
    found = {}
    for name, data in child.contents(out).items():
        path = pathlib.Path(name)
        if data is None:
            continue
        if path.parts[0] == "study" and path.parent.name != "cells" and path.name != "study.json":
            if path.name != "rows.jsonl":
                continue
            data = json.dumps([without_times(json.loads(line)) for line in data.decode().splitlines()]).encode()
        if path.parts[0] == "study" and path.name == "study.json":
            # What times were measured on, its load included, goes with the times.
            data = json.dumps({key: value for key, value in json.loads(data).items() if key != "machine"}).encode()
        found[name] = hashlib.sha256(data).hexdigest()
    return found


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("limn", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--demo", action="store_true", help="every output of `limn demo`")
    parser.add_argument("--json", type=pathlib.Path)
    options = parser.parse_args()
    folder, limn = options.folder.resolve(), options.limn.resolve()
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    # The demo takes minutes; what a third run would show, the small calls show.
    runs = RUNS[:2] if options.demo else RUNS
    first, differing = None, {}
    for words, threads in runs:
        # One name for all, so that no output may differ by it.
        out = folder / "out"
        shutil.rmtree(out, ignore_errors=True)
        run_calls(threads_of(limn, folder, threads), out, options.demo)
        found = hashes(out)
        first = first or found
        for name in sorted(set(first) | set(found)):
            if first.get(name) != found.get(name):
                differing.setdefault(name, words)
                print(f"{name} differs between {runs[0][0]} and {words}", flush=True)
    print(f"{len(first)} files hashed in {len(runs)} runs: {len(differing)} differ")
    if options.json:
        options.json.write_text(json.dumps({"demo": options.demo, "runs": [words for words, _ in runs], "files": len(first),
                                            "differing": sorted(differing)}, indent=1) + "\n")
    sys.exit(1 if differing or not first else 0)


if __name__ == "__main__":
    main()
