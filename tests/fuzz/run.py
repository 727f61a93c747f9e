#!/usr/bin/env python3
"""Runs every fuzzer for a while and prints, as JSON, how much each tried and what it found. Ends with 1 where something crashed.

run.py [--seconds N] [--target NAME ...] [--jobs N] [--json FILE]

Builds the fuzzers first (cmake --preset asan). Each starts from its corpus in tests/fuzz/corpus and keeps what it learns in the build folder.
An input that breaks something is left there too; once it is mended, the input belongs into the corpus, where every ordinary test run replays it.
"""
import argparse
import concurrent.futures
import os
import pathlib
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "verify"))
import preset  # noqa: E402

LIMITS = ["-rss_limit_mb=2560", "-malloc_limit_mb=1024", "-timeout=20"]


def fuzz(name, folder, seconds):
    work = folder / "fuzz" / name
    learnt, crashes = work / "learnt", work / "crashes"
    for each in (learnt, crashes):
        each.mkdir(parents=True, exist_ok=True)
    before = set(crashes.iterdir())
    command = [folder / f"limn-fuzz-{name}", learnt, HERE / "corpus" / name, f"-max_total_time={seconds}", f"-artifact_prefix={crashes}/",
               "-print_final_stats=1", "-reduce_inputs=1", *LIMITS]
    dictionary = HERE / "dictionaries" / f"{name}.dict"
    if dictionary.exists():
        command.append(f"-dict={dictionary}")
    environment = dict(os.environ, LSAN_OPTIONS=f"suppressions={preset.ROOT}/tests/sanitizers/leaks.supp:print_suppressions=0",
                       UBSAN_OPTIONS="print_stacktrace=1")
    # A hard end, should a fuzzer not keep to its time.
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=environment, timeout=2 * seconds + 300)
    text = done.stdout.decode(errors="replace")
    (work / "log.txt").write_text(text)
    executed = re.search(r"stat::number_of_executed_units:\s*(\d+)", text)
    progress = re.findall(r"cov: (\d+) ft: (\d+) corp: (\d+)", text)
    covered, features, inputs = (int(n) for n in progress[-1]) if progress else (0, 0, 0)
    found = sorted(str(f) for f in set(crashes.iterdir()) - before)
    return {"target": name, "exit_code": done.returncode, "executions": int(executed.group(1)) if executed else 0, "edges_covered": covered,
            "features": features, "inputs_kept": inputs, "seeds": len(list((HERE / "corpus" / name).iterdir())), "crashes": found}


def main():
    names = sorted(f.stem for f in HERE.glob("*.cpp") if f.stem != "replay")
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=int, default=60, help="for each fuzzer")
    parser.add_argument("--target", nargs="+", choices=names, default=names)
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="fuzzers at a time")
    parser.add_argument("--json", type=pathlib.Path, help="write the results there too")
    options = parser.parse_args()
    folder = preset.build("asan", "limn-fuzz")
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        results = list(pool.map(lambda name: fuzz(name, folder, options.seconds), options.target))
    good = all(r["exit_code"] == 0 and not r["crashes"] and r["executions"] > 0 for r in results)
    return preset.publish({"outcome": "held" if good else "failed", "seconds_each": options.seconds,
                           "figures": {"fuzzers": len(results), "executions": sum(r["executions"] for r in results),
                                       "crashes": sum(len(r["crashes"]) for r in results)},
                           "targets": results}, options.json)


if __name__ == "__main__":
    sys.exit(main())
