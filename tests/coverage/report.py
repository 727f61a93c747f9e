#!/usr/bin/env python3
"""Runs the tests on a build that counts, and prints how much of limn's own code they reach: lines and branches, in all and by file.

report.py [--no-run] [--files N] [--json FILE]

What is not reached is listed by reason (reasons.json: patterns of the file and of the source; the first that fits), with the places that have
none: there a test is missing. Ends with 1 below the bounds (90 % of lines, 80 % of branches), or where a test failed.

Counted are sdf, subdiv, raymarch and samples, with their helper programs, in a build of one SIMD target (plain loops: the kernels' source is the
same for all). Not counted as branches: those that only an exception takes, which the compiler adds to every call, and those of LIMN_CHECK, which
no input may ever take.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "verify"))
import preset  # noqa: E402

ROOT = preset.ROOT
BUILD = ROOT / "build" / "coverage"
LEAST = {"line": 90.0, "branch": 80.0}
FOLDERS = ("sdf", "subdiv", "raymarch", "samples")


def run_tests():
    """How many ran and failed."""
    preset.build("coverage")
    # Counts of an earlier run would be added to.
    for counts in BUILD.rglob("*.gcda"):
        counts.unlink()
    done = subprocess.run(["ctest", "--preset", "coverage"], cwd=ROOT, stdout=subprocess.PIPE)
    text = done.stdout.decode(errors="replace")
    (BUILD / "ctest.txt").write_text(text)
    summary = re.search(r"(\d+) tests failed out of (\d+)", text)
    return (int(summary.group(2)), int(summary.group(1))) if summary else (0, 0)


def measure():
    """gcovr's summary: totals, and a record for each file."""
    output = BUILD / "coverage.json"
    filters = [word for folder in FOLDERS for word in ("--filter", f"{folder}/")]
    subprocess.run(["gcovr", "--root", ".", *filters, "--exclude-throw-branches", "--exclude-unreachable-branches",
                    "--exclude-branches-by-pattern", r".*LIMN_CHECK\(.*", "--gcov-ignore-parse-errors", "-j", "2",
                    "--json-summary", str(output), "--json", str(BUILD / "coverage-lines.json"), str(BUILD)],
                   cwd=ROOT, check=True, stdout=sys.stderr)
    return json.loads(output.read_text())


def table(summary, most):
    """The files with most left out, for people."""
    files = [f for f in summary["files"] if f["line_covered"] < f["line_total"] or f["branch_covered"] < f["branch_total"]]
    files.sort(key=lambda f: (f["line_covered"] - f["line_total"], f["branch_covered"] - f["branch_total"], f["filename"]))
    lines = [f"{'file':<44} {'lines left':>14} {'branches left':>16}"]
    for f in files[:most]:
        left = [f"{f[kind + '_total'] - f[kind + '_covered']} of {f[kind + '_total']}" for kind in ("line", "branch")]
        lines.append(f"{f['filename']:<44} {left[0]:>14} {left[1]:>16}")
    if len(files) > most:
        lines.append(f"and {len(files) - most} files more; {len(summary['files']) - len(files)} have nothing left")
    return "\n".join(lines)


def runs_not_reached(file):
    """Lines that no test ran, as runs: first, last, their text."""
    source = (ROOT / file["file"]).read_text().split("\n")
    missed = [line["line_number"] for line in file["lines"] if line["count"] == 0 and not line.get("gcovr/noncode")]
    runs = []
    for line in missed:
        # A statement goes on over lines that count as none.
        if runs and line - runs[-1][-1] <= 2:
            runs[-1].append(line)
        else:
            runs.append([line])
    return [(run[0], run[-1], len(run), " ".join(source[n - 1].strip() for n in range(run[0], min(run[-1], len(source)) + 1))) for run in runs]


def reasons():
    """{reason: lines}, and [(place, lines)] without one, most lines first."""
    known = json.loads((pathlib.Path(__file__).resolve().parent / "reasons.json").read_text())
    counts, without = {rule["reason"]: 0 for rule in known}, []
    for file in json.loads((BUILD / "coverage-lines.json").read_text())["files"]:
        for first, last, count, text in runs_not_reached(file):
            fits = (rule for rule in known if re.fullmatch(rule.get("file", ".*"), file["file"]) and re.search(rule.get("text", ""), text))
            rule = next(fits, None)
            if rule:
                counts[rule["reason"]] += count
            else:
                without.append((f"{file['file']}:{first}" + (f"-{last}" if last > first else ""), count))
    return counts, sorted(without, key=lambda w: (-w[1], w[0]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--no-run", action="store_true", help="report on what the last run counted")
    parser.add_argument("--files", type=int, default=30, help="rows of the table")
    parser.add_argument("--json", type=pathlib.Path, help="write the results there")
    options = parser.parse_args()
    tests, failed = (None, 0) if options.no_run else run_tests()
    summary = measure()
    reached = {kind: 100.0 * summary[f"{kind}_covered"] / max(summary[f"{kind}_total"], 1) for kind in LEAST}
    good = failed == 0 and tests != 0 and all(reached[kind] >= LEAST[kind] for kind in LEAST)
    print(table(summary, options.files))
    by_reason, without = reasons()
    print("lines not reached, by reason:")
    for reason, count in by_reason.items():
        print(f"{count:6}  {reason}")
    places = ", ".join(f"{place} ({count})" for place, count in without[:options.files])
    more = f" and {len(without) - options.files} places more" if len(without) > options.files else ""
    print(f"{sum(count for _, count in without):6}  a test is missing: {places}{more}")
    for kind, words in (("line", "lines"), ("branch", "branches")):
        print(f"{words}: {summary[f'{kind}_covered']} of {summary[f'{kind}_total']}, {reached[kind]:.1f} % (at least {LEAST[kind]:.0f} %)")
    if tests is not None:
        print(f"tests: {tests}, failed {failed}" + (f": {BUILD / 'ctest.txt'}" if failed else ""))
    if options.json:
        figures = {f"{kind}s_percent".replace("branchs", "branches"): round(reached[kind], 2) for kind in LEAST}
        figures |= {"tests": tests, "tests_failed": failed}
        options.json.write_text(json.dumps({"outcome": "held" if good else "failed", "figures": figures,
                                            "not_reached": by_reason, "without_reason": without, "files": summary["files"]},
                                           indent=1) + "\n")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
