"""What is verified: for each part the program that does it, and what of its JSON goes into the table."""
import json
import pathlib
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
TESTS = ROOT / "tests"
NAMES = ("stability", "mutants", "kills", "determinism", "seeds", "fuzz", "asan", "tsan", "scalar", "coverage", "packages", "docs")
SUITES = ("asan", "tsan", "scalar")
BUILDING = ("fuzz", "asan", "tsan", "scalar", "coverage", "packages")


def command(name, limn, out, result, quick, again):
    python = sys.executable
    if name == "stability":
        return [limn, "stability", "-o", out / "stability", "--quiet"]
    if name == "mutants":
        return [python, TESTS / "damage" / "mutants.py", limn, out / "mutants", "--count", "20" if quick else "200", "--json", result]
    if name == "kills":
        return [python, TESTS / "damage" / "kills.py", limn, out / "kills", "--count", "10" if quick else "100", "--json", result]
    if name == "determinism":
        return [python, TESTS / "damage" / "determinism.py", limn, out / "determinism", *([] if quick else ["--demo"]), "--json", result]
    if name == "seeds":
        return [python, TESTS / "seeds" / "run.py", "--seconds", "1" if quick else "6", "--json", result]
    if name == "fuzz":
        return [python, TESTS / "fuzz" / "run.py", "--seconds", "10" if quick else "60", "--json", result]
    if name == "docs":
        return [python, TESTS / "docs" / "check.py", limn, out / "docs", "--all", "--json", result]
    if name == "packages":
        # On a machine with a slow network the first call makes the bare Debian, and takes minutes.
        return ["bash", "-c", '"$0" package && exec "$1" "$2" limn-out/packages "$3" "$4" --json "$5"', ROOT / "run", python,
                TESTS / "packages" / "install_test.py", out / "packages", TESTS / "house" / "consumer", result]
    if name == "coverage":
        return [python, TESTS / "coverage" / "report.py", "--json", result]
    return [python, TESTS / "sanitizers" / "run.py", name, "--json", result, *(["--again", again] if again else [])]


def facts_of_stability(data):
    wrong = [f"{c['case']}, {c['surface']}, {c.get('method', '')}: {c.get('message', '')}" for c in data["cells"] if c["outcome"] == "wrong"]
    return {"cases": len(data["cases"]), "cells": len(data["cells"]), **data["counts"]}, wrong


def facts_of_mutants(data):
    kinds = data["kinds"]
    figures = {key: sum(k[key] for k in kinds) for key in ("tried", "read", "refused", "incomplete")}
    ends = {}
    for kind in kinds:
        for cause, number in kind["reader_ended_by"].items():
            ends[cause] = ends.get(cause, 0) + number
    figures |= {"wrong": sum(len(k["failures"]) for k in kinds), "seed": data["seed"], "reader_ended_by": ends,
                "slowest_s": max(k["slowest_s"] for k in kinds), "peak_mb": max(k["peak_mb"] for k in kinds),
                "kinds": [{key: k[key] for key in ("kind", "tried", "read", "refused", "incomplete", "reader_ended_by")} |
                          {"wrong": len(k["failures"])} for k in kinds]}
    return figures, [f"{k['kind']}, {f['mutant']}: {f['fault']}" for k in kinds for f in k["failures"]]


def facts_of_kills(data):
    rows = [{"name": p["name"], "tried": p["tried"], "outcomes": p["outcomes"], "wrong": len(p["failures"]), "skipped": p["skipped"]}
            for p in data["parts"]]
    figures = {"tried": sum(r["tried"] for r in rows), "wrong": sum(r["wrong"] for r in rows), "seed": data["seed"], "parts": rows}
    return figures, [f"{p['name']}: {f}" for p in data["parts"] for f in p["failures"]]


def facts_of_determinism(data):
    return ({"files": data["files"], "runs": len(data["runs"]), "differing": len(data["differing"]), "demo": data["demo"]},
            [f"{name} differs between equal calls" for name in data["differing"]])


def facts_of_fuzz(data):
    return data["figures"] | {"seconds_each": data["seconds_each"]}, [c for t in data["targets"] for c in t["crashes"]]


def facts_of_suite(data):
    return data["figures"], data["failed"]


def facts_of_coverage(data):
    figures = data["figures"]
    return figures, [] if data["outcome"] == "held" else [f"lines {figures['lines_percent']} %, branches {figures['branches_percent']} %"]


def facts_of_checks(data):
    return data["figures"], data["failures"]


FACTS = {"packages": facts_of_checks, "docs": facts_of_checks, "stability": facts_of_stability, "mutants": facts_of_mutants, "kills": facts_of_kills, "determinism": facts_of_determinism,
         "seeds": facts_of_suite, "fuzz": facts_of_fuzz, "asan": facts_of_suite, "tsan": facts_of_suite, "scalar": facts_of_suite, "coverage": facts_of_coverage}


def commit():
    done = subprocess.run(["git", "describe", "--always", "--dirty", "--exclude=*"], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    return done.stdout.strip()


def run(name, limn, out, quick, again=False):
    """Runs a part to its end whatever that is, and writes what came out. `again`: of a suite only the tests that failed the last time."""
    result, before, revision = out / f"{name}.raw.json", None, commit()
    if again and name in SUITES and result.exists():
        before = result.rename(out / f"{name}.before.json")
        revision = f"{read_all(out)[name]['commit']}, again {revision}"
    result.unlink(missing_ok=True)
    started = time.monotonic()
    log = out / f"{name}.log"
    with open(log, "w") as stream:
        code = subprocess.run([str(c) for c in command(name, limn, out, result, quick, before)], stdout=stream, stderr=subprocess.STDOUT, cwd=ROOT).returncode
    if name == "stability":
        result = out / "stability" / "results.json"
    record = {"part": name, "outcome": "held" if code == 0 else "failed", "figures": {}, "failures": [], "commit": revision,
              "quick": quick, "seconds": round(time.monotonic() - started, 1)}
    try:
        record["figures"], record["failures"] = FACTS[name](json.loads(result.read_text()))
    except (OSError, ValueError, KeyError, TypeError) as problem:
        record["outcome"] = "failed"
        record["failures"] = [f"no results ({type(problem).__name__}: {problem}); {log} has the last words"]
    if code != 0 and not record["failures"]:
        record["failures"] = [f"ended with {code}; {log} has the last words"]
    (out / f"{name}.json").write_text(json.dumps(record, indent=1) + "\n")
    return record


def read_all(out):
    """Part -> what it wrote, or "not run"."""
    records = {}
    for name in NAMES:
        file = pathlib.Path(out) / f"{name}.json"
        try:
            records[name] = json.loads(file.read_text())
        except (OSError, ValueError):
            records[name] = {"part": name, "outcome": "not run", "figures": {}, "failures": [], "commit": "", "quick": False, "seconds": 0.0}
    return records
