#!/usr/bin/env python3
"""Predicted displacements against measured ones: of all models of a study, the median error is at most a quarter, and at least nine in ten
measured values lie in the interval that the prediction states.

predictions.py LIMN FOLDER [INPUT...]      built-in scenes or subdivision cages; without: a quick one of each kind; all: the nine scenes
"""
import csv
import math
import pathlib
import statistics
import subprocess
import sys

import scenes

QUICK = ("tilted_torus", "rook")
MODELS = ("--voxels", "32..256", "--levels", "1..4", "--views", "2", "--size", "320x240", "--methods", "rim", "--thresholds", "0.4")
SETTINGS = ("surface", "voxels", "level", "normals", "gradient", "view")
MOST_ERROR, LEAST_INSIDE = 0.25, 0.9


def study(limn, scene, folder):
    """Of each model and view what `prediction` yields, by name; the formula itself has nothing to predict."""
    cage = ["--scheme", "catmark"] if pathlib.Path(scene).suffix else []
    done = subprocess.run([str(part) for part in (limn, "study", scene, *cage, *MODELS, "-o", folder, "-q", "--fresh")],
                          capture_output=True, text=True, timeout=1200)
    if done.returncode != 0:
        sys.exit(f"study of {scene} ended with {done.returncode}: {done.stderr}")
    cells = {}
    with open(folder / "rows.csv", newline="", encoding="utf-8") as rows:
        for row in csv.DictReader(rows):
            if row["surface"] != "analytic" and row["metric"].startswith("prediction_") and row["value"]:
                cells.setdefault(tuple(row[name] for name in SETTINGS), {})[row["metric"]] = float(row["value"])
    return cells


def judge(cells):
    errors, inside = [], []
    for values in cells.values():
        predicted, measured = (values.get(f"prediction_{name}_rms", math.nan) for name in ("displacement", "measured"))
        if not (math.isfinite(predicted) and measured > 0.0):
            continue
        errors.append(abs(predicted - measured) / measured)
        inside.append(values["prediction_displacement_low"] <= measured <= values["prediction_displacement_high"])
    return errors, inside


def main():
    limn, folder, names = scenes.arguments(__doc__, QUICK)
    wrong = 0
    for scene in names:
        name = pathlib.Path(scene).stem
        errors, inside = judge(study(limn, scene, folder / name))
        if not errors:
            sys.exit(f"{name}: nothing was predicted")
        error, share = statistics.median(errors), sum(inside) / len(inside)
        good = error <= MOST_ERROR and share >= LEAST_INSIDE
        wrong += not good
        print(f"{name}: {len(errors)} models and views, median error {100 * error:.1f} %, inside the interval "
              f"{100 * share:.0f} %{'' if good else '  WRONG'}", flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
