#!/usr/bin/env python3
"""Feeds damaged files to limn: whatever they hold, it ends with 0 or 2 within time and memory, says what is wrong with which file, and leaves
no output of a run that failed, nor anything else.

mutants.py LIMN FOLDER [--count N] [--seed S] [--kind NAME]... [--corpus-only] [--json FILE]

Originals are made afresh in FOLDER (originals.py); --count mutants of each (mutation.py) go through commands that read and write by turns. Then
the corpus beside this script: every file that once did harm. What fails is printed with the seed and kept in FOLDER/failed.
"""
import collections
import pathlib
import random
import re
import shutil
import sys

import child
import mutation
import originals

HERE = pathlib.Path(__file__).resolve().parent
TIME_LIMIT_S = 60  # of processor time, because others may be at work on the machine
PATIENCE_S = 300
MEMORY_LIMIT = 2 << 30  # resident, of the program and of each of its readers
ADDRESS_SPACE = 12 << 30
TEXT_KINDS = ("toml", "obj", "obj tags", "ply ascii", "shard")
# What a guarded reader's end makes the message say.
GUARD_WORDS = {"crashed": "crash", "took longer": "time", "processor time": "time", "of memory": "memory", "gave up": "gave up"}
KIND_OF_ENDING = {".toml": "toml", ".vdb": "vdb", ".obj": "obj", ".ply": "ply binary", ".stl": "stl", ".glb": "glb", "": "shard"}


def commands(limn, kind, file, out):
    """The calls that mutants of a kind go through by turns, and what each writes."""
    if kind == "shard":
        return [([limn, "merge", file, "-o", out / "merged", "--quiet"], out / "merged")]
    if kind in originals.PICTURES:
        return [([limn, "info", file], None), ([limn, "info", file, "--json"], None)]
    picture, mesh, volume = out / "out.png", out / "out.obj", out / "out.vdb"
    render = ([limn, "render", file, "-o", picture, "--size", "32x24", "--threads", "1", "--quiet"], picture)
    layers = ([limn, "render", file, "-o", out / "out.exr", "--size", "32x24", "--threads", "1", "--quiet"], out / "out.exr")
    to_volume = ([limn, "export", file, "-o", volume, "--threads", "1", "--quiet"] + ([] if kind.startswith("vdb") else ["--voxels", "16"]), volume)
    to_mesh = ([limn, "export", file, "-o", mesh, "--threads", "1", "--quiet"] + (["--level", "1"] if kind == "toml" else []), mesh)
    if kind.startswith("vdb"):
        to_mesh[0].extend(["--surface", "level_set"])
    return [render, to_volume, layers, ([limn, "info", file], None)] + ([] if kind == "toml" else [to_mesh])


def message_fault(done, kind, file):
    lines = done.err_lines
    if not lines:
        return "says nothing"
    if any(not line.startswith("limn: ") for line in lines):
        return "says something that is not limn's"
    last = lines[-1]
    if file.name not in last:
        return "does not name the file"
    reason = last[last.index(file.name) + len(file.name):]
    return "" if re.search(r"[a-z]{3}", reason) else "gives no reason"


def fault(done, kind, file, output):
    """What the program did that it may not; empty where nothing."""
    if done.timed_out or done.cpu_seconds > TIME_LIMIT_S:
        return f"took {done.cpu_seconds:.0f} s of processor time in {done.seconds:.0f} s"
    if done.code not in ((0, 1, 2) if kind == "shard" else (0, 2)):
        return f"ended with {done.code}"
    if done.peak_bytes > MEMORY_LIMIT:
        return f"took {done.peak_bytes >> 20} MB"
    if done.code == 0:
        return "wrote nothing" if output and not output.exists() else ""
    # A part that lost its last cells is a part of a study that was stopped: the rest is merged, the missing ones are named.
    if done.code == 1:
        return "" if output.exists() and "missing" in done.err else "ended with 1"
    if output and output.exists():
        return "left an output behind"
    return message_fault(done, kind, file)


def try_one(limn, kind, file, work, turn):
    """Runs it once. (what ended how, its fault)"""
    out = work / "out"
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir()
    calls = commands(limn, kind, file, out)
    command, output = calls[turn % len(calls)]
    before = child.contents(work, but=("out",))
    done = child.run(command, seconds=PATIENCE_S, address_space=ADDRESS_SPACE)
    found = fault(done, kind, file, output)
    left = [name for name in child.contents(out) if output is None or not (out / name).is_relative_to(output) or done.code == 2]
    hidden = [str(p.relative_to(work)) for p in work.rglob(".limn-*")]
    if not found and (left or hidden):
        found = f"left {', '.join(left + hidden)}"
    if not found and child.contents(work, but=("out",)) != before:
        found = "changed its input"
    return done, found, command


def place_mutant(kind, original, data, work, number):
    """A copy of the original with other bytes: for a shard, of its folder with one file of it changed."""
    if original.is_file():
        file = work / f"mutant{original.suffix}"
        file.write_bytes(data)
        return file
    copy = work / "mutant"
    shutil.rmtree(copy, ignore_errors=True)
    shutil.copytree(original, copy)
    parts = originals.files_of(copy)
    parts[number % len(parts)].write_bytes(data)
    return copy


def keep(file, failed, name):
    failed.mkdir(exist_ok=True)
    if file.is_dir():
        shutil.copytree(file, failed / name, dirs_exist_ok=True)
    else:
        shutil.copy(file, failed / (name + file.suffix))


class Tally:
    def __init__(self, kind):
        self.kind, self.tried, self.worst_s, self.peak = kind, 0, 0.0, 0
        self.ends, self.guarded, self.failures = collections.Counter(), collections.Counter(), []

    def count(self, done, found, name, command):
        self.tried += 1
        self.worst_s, self.peak = max(self.worst_s, done.cpu_seconds), max(self.peak, done.peak_bytes)
        self.ends[{0: "read", 1: "incomplete", 2: "refused"}.get(done.code, "other")] += 1
        for words, cause in GUARD_WORDS.items():
            if done.code == 2 and words in done.err:
                self.guarded[cause] += 1
                break
        if found:
            self.failures.append({"mutant": name, "fault": found, "said": done.err.strip()[:400], "command": " ".join(map(str, command))})
            print(f"{self.kind}, {name}: {found}\n  {' '.join(map(str, command))}\n  {done.err.strip()[:400]}", flush=True)

    def record(self):
        return {"kind": self.kind, "tried": self.tried, "read": self.ends["read"], "refused": self.ends["refused"],
                "incomplete": self.ends["incomplete"], "reader_ended_by": dict(self.guarded), "slowest_s": round(self.worst_s, 2),
                "peak_mb": self.peak >> 20, "failures": self.failures}

    def line(self):
        r = self.record()
        guarded = "".join(f", {n} by the reader's {cause}" for cause, n in sorted(self.guarded.items()))
        lost = f", {r['incomplete']} incomplete" if r["incomplete"] else ""
        return (f"{self.kind:14} {self.tried:5} mutants: {r['read']:4} read{lost}, {r['refused']:4} refused{guarded}; slowest {r['slowest_s']:.1f} s, "
                f"most {r['peak_mb']} MB; {len(self.failures)} wrong")


def try_kind(limn, kind, original, folder, count, seed):
    work = folder / "work"
    tally = Tally(kind)
    sources = [file.read_bytes() for file in originals.files_of(original)]
    for turn in range(len(commands(limn, kind, original, work))):
        done, found, command = try_one(limn, kind, place_mutant(kind, original, sources[0], work, 0), work, turn)
        if done.code != 0 or found:
            sys.exit(f"mutants: the undamaged {kind} is refused, which would prove nothing: {found} {done.err}\n  {' '.join(map(str, command))}")
    for number in range(count):
        random_numbers = random.Random(f"{seed} {kind} {number}")
        data = mutation.damage(sources[number % len(sources)], kind in TEXT_KINDS, random_numbers)
        file = place_mutant(kind, original, data, work, number)
        done, found, command = try_one(limn, kind, file, work, number // len(sources))
        tally.count(done, found, f"seed {seed} number {number}", command)
        if found:
            keep(file, folder / "failed", f"{kind.replace(' ', '-')}-{seed}-{number}")
    return tally


def try_corpus(limn, folder):
    """Every file of it through every command."""
    tally = Tally("corpus")
    for kept in sorted((HERE / "corpus").iterdir()):
        kind = KIND_OF_ENDING.get(kept.suffix, kept.suffix[1:])
        for turn in range(len(commands(limn, kind, kept, folder))):
            work = folder / "work"
            shutil.rmtree(work, ignore_errors=True)
            work.mkdir()
            file = work / kept.name
            shutil.copytree(kept, file) if kept.is_dir() else shutil.copy(kept, file)
            done, found, command = try_one(limn, kind, file, work, turn)
            tally.count(done, found, f"corpus/{kept.name}", command)
    return tally


def main():
    parser = child.random_trials(__doc__, count=200)
    parser.add_argument("--kind", action="append")
    parser.add_argument("--corpus-only", action="store_true")
    options = child.trials(parser)
    limn, folder = options.limn, options.folder
    tallies = []
    if not options.corpus_only:
        shutil.rmtree(folder / "made", ignore_errors=True)
        (folder / "made").mkdir(parents=True)
        for kind, original in originals.make(limn, folder / "made").items():
            if options.kind and kind not in options.kind:
                continue
            shutil.rmtree(folder / "work", ignore_errors=True)
            (folder / "work").mkdir()
            tallies.append(try_kind(limn, kind, original, folder, options.count, options.seed))
            print(tallies[-1].line(), flush=True)
    folder.mkdir(parents=True, exist_ok=True)
    tallies.append(try_corpus(limn, folder))
    print(tallies[-1].line(), flush=True)
    return child.report(options, "kinds", tallies)


if __name__ == "__main__":
    sys.exit(main())
