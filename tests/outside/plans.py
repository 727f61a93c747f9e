#!/usr/bin/env python3
"""Plans and studies agree: what a plan chose has the same error in a study of that model, and the study calls it right to half a pixel where
the plan was asked for that.

plans.py LIMN FOLDER [SCENE...]      without scenes: a quick one of each kind; all: the nine built-in scenes
"""
import csv
import json
import subprocess
import sys

import scenes

QUICK = ("ellipsoid", "rook")
TOLERANCES = (1.0, 0.5, 0.25)
VIEW = ("--size", "480x270", "--views", "1")


def run(command, fine=(0,)):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=1200)
    if done.returncode not in fine:
        sys.exit(f"{' '.join(map(str, command))} ended with {done.returncode}: {done.stderr}")
    return done.stdout


def study_error(limn, scene, trial, folder):
    """What 95 % of the model's border lie within, by the study's rows, and the study's page."""
    options = ["--surfaces", trial["surface"]]
    for name, option in (("voxels", "--voxels"), ("gradient", "--gradients"), ("level", "--levels"), ("normals", "--normals")):
        if name in trial["parameters"]:
            options += [option, str(trial["parameters"][name])]
    run([limn, "study", scene, *options, *VIEW, "--methods", "rim", "--thresholds", "0.4", "-o", folder, "-q", "--fresh"])
    with open(folder / "rows.csv", newline="", encoding="utf-8") as rows:
        errors = [float(row["value"]) for row in csv.DictReader(rows) if row["metric"] == "border_error_p95"]
    page = (folder / "report.html").read_text(encoding="utf-8")
    return errors, page


def main():
    limn, folder, names = scenes.arguments(__doc__, QUICK)
    wrong = 0
    for scene in names:
        for tolerance in TOLERANCES:
            plan = json.loads(run([limn, "plan", scene, "--tolerance", tolerance, *VIEW, "--json", "-q"], fine=(0, 1)))
            chosen = plan.get("chosen")
            if not chosen:
                print(f"{scene}, {tolerance} px: nothing keeps to it within the limits", flush=True)
                continue
            errors, page = study_error(limn, scene, chosen, folder / f"{scene}_{tolerance}")
            planned = chosen["measured_px"]
            same = len(errors) == 1 and abs(errors[0] - planned) <= 1e-6 * planned + 1e-9
            good = same and planned <= tolerance and (tolerance != 0.5 or "border is right to 0.5 px" in page)
            wrong += not good
            words = ", ".join(str(value) for value in chosen["parameters"].values())
            print(f"{scene}, {tolerance} px: {chosen['surface']} ({words}): plan {planned:.4g} px, study {errors[0]:.4g} px"
                  f"{'' if good else '  WRONG'}", flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
