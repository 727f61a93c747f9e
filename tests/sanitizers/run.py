#!/usr/bin/env python3
"""Builds a preset whose build watches limn (asan, tsan) or leaves something out (scalar), runs its tests and prints JSON.

run.py asan|tsan|scalar [--jobs N] [--json FILE] [--only REGEX] [--again FILE]

--again FILE: of the tests in those earlier results only the failed ones run; what the others did is kept, and how many ran again is told.

Ends with 1 where a test failed. Tests that the preset leaves out (CMakePresets.json) are counted, as those are that say they skip.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys
import time
import xml.etree.ElementTree

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "verify"))
import preset  # noqa: E402


def count_all(folder):
    listed = subprocess.run(["ctest", "--test-dir", str(folder), "--show-only=json-v1"], stdout=subprocess.PIPE, check=True)
    return len(json.loads(listed.stdout)["tests"])


def merged(before, now):
    """Earlier results, with what became of the tests that had failed."""
    figures = before["figures"] | {"failed": len(now["failed"]), "seconds": before["figures"]["seconds"] + now["figures"]["seconds"],
                                   "ran_again": before["figures"].get("ran_again", 0) + len(before["failed"])}
    return now | {"figures": figures}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("preset", choices=("asan", "tsan", "scalar"))
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", help="tests whose name matches")
    parser.add_argument("--again", type=pathlib.Path, help="earlier results, of which the failed tests run again")
    parser.add_argument("--json", type=pathlib.Path, help="write the results there too")
    options = parser.parse_args()
    folder = preset.build(options.preset)
    report = folder / "tests.xml"
    report.unlink(missing_ok=True)
    started = time.monotonic()
    before = json.loads(options.again.read_text()) if options.again else None
    if before and not before["failed"]:
        return preset.publish(before, options.json)
    only = ["-R", options.only] if options.only else []
    if before:
        only = ["-R", "^(" + "|".join(re.escape(name) for name in before["failed"]) + ")$"]
    subprocess.run(["ctest", "--preset", options.preset, "-j", str(options.jobs), "--output-junit", str(report), *only], cwd=preset.ROOT,
                   stdout=sys.stderr)
    suite = xml.etree.ElementTree.parse(report).getroot()
    failed = [case.get("name") for case in suite.iter("testcase") if case.get("status") == "fail"]
    ran = int(suite.get("tests")) - int(suite.get("skipped")) - int(suite.get("disabled"))
    good = ran > 0 and not failed
    results = {"outcome": "held" if good else "failed", "preset": options.preset,
               "figures": {"tests": ran, "failed": len(failed), "skipped": int(suite.get("skipped")),
                           "left_out": count_all(folder) - int(suite.get("tests")), "seconds": round(time.monotonic() - started)},
               "failed": failed}
    return preset.publish(merged(before, results) if before else results, options.json)


if __name__ == "__main__":
    sys.exit(main())
