#!/usr/bin/env python3
"""Runs every test with random input again and again, each time with another seed, and prints as JSON which failed with which.

run.py [--seconds N] [--first SEED] [--only REGEX] [--jobs N] [--build FOLDER] [--json FILE]

Tests are those that print their seed (tests/random_seed.h). Each takes so many seconds, at least one run, and no more after three failures.
A fault that one run in a thousand shows will sooner or later stop somebody's commit. Ends with 1 where a test failed.
"""
import argparse
import concurrent.futures
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "verify"))
import preset  # noqa: E402

PROGRAMS = ("sdf", "subdiv", "raymarch", "samples")
MOST_FAILURES = 3
LONGEST_S = 1200  # One run.


def with_seeds(program, folder):
    """Names of a program's tests whose file speaks of seeds; with parameters all of them are one."""
    names = []
    for source in sorted((HERE.parent / folder).glob("*.cpp")):
        text = source.read_text()
        if "seed" not in text:
            continue
        for kind, suite, name in re.findall(r"^TEST(_P|_F)?\((\w+),\s*(\w+)\)", text, re.MULTILINE):
            names.append(f"*{suite}.{name}*" if kind == "_P" else f"{suite}.{name}")
    return [(program, name) for name in names]


def one_run(program, name, seed, work):
    environment = dict(os.environ, LIMN_SEED=str(seed))
    try:
        done = subprocess.run([program, f"--gtest_filter={name}"], cwd=work, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              timeout=LONGEST_S)
    except subprocess.TimeoutExpired:
        return False, f"seed {seed}: not done after {LONGEST_S} s"
    return done.returncode == 0, done.stdout.decode(errors="replace")


def repeat(program, name, seconds, first, work):
    """The seeds that failed, how often it ran (0: it draws nothing), and what the first failure said."""
    failed, said, runs, started = [], "", 0, time.monotonic()
    with tempfile.TemporaryDirectory(dir=work) as folder:
        while runs == 0 or (time.monotonic() - started < seconds and len(failed) < MOST_FAILURES):
            seed = first + runs
            passed, text = one_run(program, name, seed, folder)
            runs += 1
            if not passed:
                failed.append(seed)
                said = said or text
            elif runs == 1 and f"seed {seed}" not in text:
                return [], 0, ""
    return failed, runs, said


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=6.0, help="for each test; default 6")
    parser.add_argument("--first", type=int, help="the first seed; default: any")
    parser.add_argument("--only", default="", help="tests whose name matches")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--build", type=pathlib.Path, default=preset.ROOT / "build" / "release")
    parser.add_argument("--json", type=pathlib.Path, help="write the results there too")
    options = parser.parse_args()
    first = random.randrange(2**30) if options.first is None else options.first
    tests = []
    for program in PROGRAMS:
        tests += with_seeds(str(options.build.resolve() / f"limn-test-{program}"), program)
    tests = [t for t in tests if re.search(options.only, t[1])]
    started, failed, drawn, runs = time.monotonic(), [], 0, 0
    with tempfile.TemporaryDirectory() as work, concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        under_way = {pool.submit(repeat, *test, options.seconds, first, work): test for test in tests}
        for done in concurrent.futures.as_completed(under_way):
            program, name = under_way[done]
            seeds, count, said = done.result()
            drawn, runs = drawn + (count > 0), runs + count
            for seed in seeds:
                failed.append(f"LIMN_SEED={seed} {pathlib.Path(program).name} --gtest_filter='{name}'")
            if seeds:
                print(f"{failed[-len(seeds)]}\n{said}", file=sys.stderr, flush=True)
    results = {"outcome": "held" if drawn and not failed else "failed", "failed": sorted(failed),
               "figures": {"tests": drawn, "runs": runs, "failed": len(failed), "first_seed": first, "seconds": round(time.monotonic() - started, 1)}}
    return preset.publish(results, options.json)


if __name__ == "__main__":
    sys.exit(main())
