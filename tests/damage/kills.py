#!/usr/bin/env python3
"""What the machine may do to limn while it works: signals at random moments, a full disk, a read-only folder, an output folder that vanishes,
a closed or full standard output.

kills.py LIMN FOLDER [--count N] [--seed S] [--only PART]... [--brief] [--json FILE]

PARTs: the commands that are killed (render, compare, study, export, merge; --count times each, the signal and the moment chosen by --seed), and
disk_full, read_only, folder_gone, streams (--brief: on fewer calls). After each kill every output is the old file or the new one, byte for byte, and no old one
stands unmarked beside a new one; after the next start nothing temporary is left and the result is that of a run nobody disturbed.
"""
import collections
import json
import os
import pathlib
import random
import shutil
import signal
import sys
import time

import child
import machine

SCENE = "[[object]]\nshape = \"ellipsoid\"\nradii = [1.0, 0.7, 0.5]\n[border]\nthreshold = {}\n"
SIGNALS = {"SIGINT": signal.SIGINT, "SIGTERM": signal.SIGTERM, "SIGKILL": signal.SIGKILL}
PATIENCE_S = 60
UNFINISHED = "compare.unfinished"


class Tally:
    def __init__(self, name):
        self.name, self.tried, self.outcomes, self.failures, self.skipped = name, 0, collections.Counter(), [], ""

    def fail(self, what, said=""):
        self.failures.append(what)
        print(f"{self.name}: {what}\n  {said.strip()[:400]}", flush=True)

    def record(self):
        return {"name": self.name, "tried": self.tried, "outcomes": dict(sorted(self.outcomes.items())), "failures": self.failures,
                "skipped": self.skipped}

    def line(self):
        if self.skipped:
            return f"{self.name:12} skipped: {self.skipped}"
        return f"{self.name:12} {self.tried:4} tried: " + ", ".join(f"{n} {k}" for k, n in sorted(self.outcomes.items())) + \
            f"; {len(self.failures)} wrong"


def jobs(limn, folder):
    """Name -> the call that wrote the old outputs and the one that writes the new ones, both into `out`; None where there are no old ones."""
    old, new = folder / "old.toml", folder / "new.toml"
    old.write_text(SCENE.format(0.3))
    new.write_text(SCENE.format(0.5))
    parts = {}
    for scene in (old, new):
        parts[scene] = folder / f"parts-{scene.stem}"
        for part in ("1/2", "2/2"):
            child.must([limn, "study", scene, "-o", parts[scene], "--shard", part, "--levels", "0,1", "--voxels", "8,16", "--views", "2",
                        "--size", "48x36", "--quiet"])
    def both(make):
        return make(old), make(new)
    return {
        "render": lambda out: both(lambda s: [limn, "render", s, "-o", out / "a.exr", "-o", out / "b.png", "--size", "640x480", "--voxels", "128",
                                              "--surface", "level_set", "-q"]),
        "compare": lambda out: both(lambda s: [limn, "compare", s, "-o", out, "--size", "200x150", "--voxels", "48", "--no-timings", "-q"]),
        "export": lambda out: tuple([limn, "export", old, "-o", out / "a.ply", "--level", level, "-q"] for level in ("4", "6")),
        "study": lambda out: (None, [limn, "study", new, "-o", out, "--levels", "0,1", "--voxels", "8,16", "--views", "2", "--size", "48x36", "-q"]),
        "merge": lambda out: (None, [limn, "merge", parts[new], "-o", out, "-q"]),
    }


def temporaries(out):
    return [name for name in child.contents(out) if pathlib.Path(name).name.startswith(".limn-")]


def without_times(contents):
    """A study measures time, and draws it: of its files those that hold what was computed, less that."""
    kept = {}
    for name, data in contents.items():
        if name.startswith("cells/") and name.endswith(".png"):
            kept[name] = data
        elif name == "rows.jsonl":
            rows = [json.loads(line) for line in data.decode().splitlines()]
            kept[name] = [{k: v for k, v in row.items() if not k.endswith("_ms")} for row in rows]
        else:
            kept[name] = None
    return kept


def check_files(name, out, old, new, tally, what):
    """Each file is the old one or the new one. Journals of a study grow; the next start judges them."""
    if name in ("study", "merge"):
        return
    there = {file: data for file, data in child.contents(out, but=(UNFINISHED,)).items()
             if data is not None and not pathlib.Path(file).name.startswith(".limn-")}
    for file, data in there.items():
        if data not in (old.get(file), new.get(file)):
            tally.fail(f"{what}: {file} is neither the old file nor the new one")
    # What belongs together is of one call, or it shows: a file is missing, or the folder says that it is unfinished.
    are_new = {data == new[file] for file, data in there.items() if file in old and old[file] != new.get(file)}
    if len(are_new) > 1 and not (out / UNFINISHED).exists():
        tally.fail(f"{what}: old files stand beside new ones and nothing says so")


def kill_once(name, calls, out, old, new, moment, random_numbers, tally):
    sent = random_numbers.choice(sorted(SIGNALS))
    what = f"{sent} after {moment:.3f} s"
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir()
    for file, data in old.items():
        (out / file).parent.mkdir(parents=True, exist_ok=True)
        if data is not None:
            (out / file).write_bytes(data)
    with open(os.devnull, "w") as nothing:
        process = child.start(calls[1], stdout=nothing, stderr=nothing)
        time.sleep(moment)
        if child.wait(process, 0) is None:
            process.send_signal(SIGNALS[sent])
            if child.wait(process, PATIENCE_S) is None:
                process.kill()
                child.wait(process, PATIENCE_S)
                return tally.fail(f"{what}: still running {PATIENCE_S} s later")
    allowed = {"SIGINT": 130, "SIGTERM": 143, "SIGKILL": -9}[sent]
    # While its libraries are loaded a program has no handlers; whoever waits for it sees the same number, and nothing was begun.
    too_early = process.returncode == -SIGNALS[sent] and sent != "SIGKILL" and child.contents(out) == old
    tally.outcomes["done before" if process.returncode == 0 else f"{sent} while loading" if too_early else f"ended by {sent}"] += 1
    if process.returncode not in (0, allowed) and not too_early:
        tally.fail(f"{what}: ended with {process.returncode} instead of {allowed}")
    if sent != "SIGKILL" and temporaries(out):
        tally.fail(f"{what}: left {temporaries(out)}")
    if temporaries(out):
        tally.outcomes["temporary files left, gone at the next start"] += 1
    check_files(name, out, old, new, tally, what)
    again = child.run(calls[1], seconds=PATIENCE_S)
    if again.code != 0:
        return tally.fail(f"{what}: the next start ended with {again.code}", again.err)
    now = child.contents(out)
    if temporaries(out):
        tally.fail(f"{what}: {temporaries(out)} outlived the next start")
    same = without_times(now) == without_times(new) if name in ("study", "merge") else now == new
    if not same:
        differing = sorted(k for k in set(now) | set(new) if now.get(k) != new.get(k))
        tally.fail(f"{what}: after the next start the result is another than undisturbed: {differing[:5]}")


def kill(name, make, folder, count, seed, loading):
    tally = Tally(name)
    out = folder / name
    calls = make(out)
    held = []
    took = 0.0
    for call in calls:
        shutil.rmtree(out, ignore_errors=True)
        out.mkdir()
        if call:
            took = child.must(call).seconds
        held.append(child.contents(out))
    old, new = held
    for number in range(count):
        tally.tried += 1
        numbers = random.Random(f"{seed} {name} {number}")
        # Half a loading time early, so that the first moments of limn's own are among them; most of that is the dynamic linker's.
        kill_once(name, calls, out, old, new, numbers.uniform(0.5 * loading, took), numbers, tally)
    return tally


def main():
    parser = child.random_trials(__doc__, count=100)
    parser.add_argument("--only", action="append")
    parser.add_argument("--brief", action="store_true")
    options = child.trials(parser)
    limn, folder = options.limn, options.folder
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    tallies = []
    loading = min(child.must([limn, "--version"]).seconds for _ in range(5))
    work = [(name, lambda make=make, name=name: kill(name, make, folder, options.count, options.seed, loading)) for name, make in jobs(limn, folder).items()]
    work += [(name, lambda check=check, name=name: check(limn, folder / name, Tally(name), options.brief)) for name, check in machine.CHECKS.items()]
    for name, do in work:
        if options.only and name not in options.only:
            continue
        tallies.append(do())
        print(tallies[-1].line(), flush=True)
    return child.report(options, "parts", tallies)


if __name__ == "__main__":
    sys.exit(main())
