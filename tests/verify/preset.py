"""Builds a preset, and hands results on: what the programs share that run the tests in a build of their own."""
import json
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


def build(preset, *targets):
    """Returns its build folder. What the build says goes to standard error: standard output is for the results."""
    folder = ROOT / "build" / preset
    if not (folder / "build.ninja").exists():
        subprocess.run(["cmake", "--preset", preset], cwd=ROOT, check=True, stdout=sys.stderr)
    wanted = [word for target in targets for word in ("--target", target)]
    subprocess.run(["cmake", "--build", "--preset", preset, *wanted], cwd=ROOT, check=True, stdout=sys.stderr)
    return folder


def publish(record, file):
    """To standard output, and into a file where one is given; returns the exit code."""
    text = json.dumps(record, indent=1)
    if file:
        file.write_text(text + "\n")
    print(text)
    return 0 if record["outcome"] == "held" else 1
