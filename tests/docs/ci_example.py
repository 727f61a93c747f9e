#!/usr/bin/env python3
"""The example of a gate in a pipeline passes as it is, fails where its renderer regresses, and says which limits were exceeded.

ci_example.py LIMN FOLDER
"""
import os
import pathlib
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

EXAMPLE = pathlib.Path(__file__).resolve().parent.parent.parent / "samples" / "ci_example"
FAILURES = []


def check(fine, text):
    if not fine:
        FAILURES.append(text)
        print(f"wrong: {text}")


def failed_cases(file):
    suite = ElementTree.parse(file).getroot()
    cases = suite.findall("testcase")
    check(int(suite.get("tests")) == len(cases), f"{file.name} counts {suite.get('tests')} tests, and has {len(cases)}")
    failed = [case.get("name") for case in cases if case.find("failure") is not None]
    check(int(suite.get("failures")) == len(failed), f"{file.name} counts {suite.get('failures')} failures, and has {len(failed)}")
    return len(cases), failed


def run(project, limn_folder, *options):
    environment = os.environ | {"PATH": f"{limn_folder}:{os.environ['PATH']}"}
    done = subprocess.run([project / "check.sh", project / "out", *options], env=environment, capture_output=True, text=True, timeout=300)
    print(done.stdout)
    check(not done.stderr, f"check.sh {options} prints {done.stderr}")
    return done.returncode


def main():
    limn, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(EXAMPLE, folder / "project")
    project, out = folder / "project", folder / "project" / "out"
    check(run(project, limn.parent) == 0, "the gate does not pass")
    check(failed_cases(out / "judge.xml") == (3, []), f"judge.xml: {failed_cases(out / 'judge.xml')}")
    check(failed_cases(out / "compare.xml") == (1, []), f"compare.xml: {failed_cases(out / 'compare.xml')}")
    check((out / "judge.html").exists() and (out / "compared" / "report.html").exists(), "the pages are not there")
    check(run(project, limn.parent, "--regression") == 1, "the gate passes a regression")
    _, failed = failed_cases(out / "judge.xml")
    check({name.split()[0] for name in failed} == {"missed", "displaced"}, f"the regression fails {failed}")
    # A coarser mesh is not right to a twentieth of a pixel, and a limit that cannot hold fails by name.
    script = project / "check.sh"
    script.write_text(script.read_text().replace("--level 4 --max-displaced 0.5", "--level 1 --max-displaced 0.05 --max-differ 1%"))
    check(run(project, limn.parent) == 1, "the gate passes a coarse mesh")
    cases, failed = failed_cases(out / "compare.xml")
    check(cases == 2 and {name.split()[0] for name in failed} == {"differ", "displaced"}, f"the coarse mesh fails {failed} of {cases}")
    print(f"{len(FAILURES)} failures")
    sys.exit(1 if FAILURES else 0)


if __name__ == "__main__":
    main()
