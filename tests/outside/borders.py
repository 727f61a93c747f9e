#!/usr/bin/env python3
"""Measures with numpy, and without any code of limn's, how far the borders of coarse models lie from the true ones, and compares the result
with the rows of `limn study`.

borders.py LIMN FOLDER

True borders are solved here, on the surfaces' own formulas. A model's border is read off a picture that limn renders of it, larger than the
study's: the inner border where N.V, interpolated between pixel centres, crosses the threshold; the silhouette from the coverage of pixels.
Pictures of the surfaces themselves go the same way first: they show what this measurement is worth.

What is not compared: silhouettes before another part of the surface (coverage does not show them; at most 2 % of a view here), and normals
that jump from facet to facet (between the pixels beside a jump there is nothing to interpolate).
"""
import pathlib
import shutil
import subprocess
import sys

try:
    import numpy  # noqa: F401
except ImportError:
    print("skipped: no numpy; the package python3-numpy brings it")
    sys.exit(77)

import displacement
import rows
import surfaces
from camera import Camera
from curves import true_border
from exr import read_exr

SIZE = (320, 240)
SAMPLES = 80
THRESHOLD = 0.4
FLOOR_PX = 0.005
AGREES_SHARE, AGREES_PX = 0.1, 0.005
MOST_MISSING = 0.02
STATISTICS = ("rms", "p95", "mean")
WIDTHS = (10, 52, 11, 6, 9, 9, 11)


def cases():
    """Surfaces, cameras, and the models of a study."""
    # The far side of the torus' hole hides behind the near one: its silhouette has cusps.
    eye = (0.5, 1.9, 4.4)
    yield (surfaces.Torus(1.0, 0.38, (1.0, 0.2, 0.3), 14.0), Camera(eye, (0.0, 0.0, 0.0), 34.0, SIZE),
           ("--surfaces", "level_set,mesh", "--voxels", "24,48", "--gradients", "central", "--levels", "1,2", "--normals", "limit"))
    eye = (2.2, 1.6, 2.9)
    yield (surfaces.Ellipsoid((1.0, 0.7, 0.5), (0.3, 1.0, 0.2), 25.0, eye), Camera(eye, (0.02, 0.03, 0.0), 28.0, SIZE),
           ("--surfaces", "level_set,mesh", "--voxels", "24", "--gradients", "cubic", "--levels", "1,2", "--normals", "vertex"))
    yield (surfaces.BicubicRing(9, 6), Camera((0.9, 0.7, 6.0), (0.0, 0.0, 0.0), 36.0, SIZE),
           ("--surfaces", "mesh,mesh_level_set", "--voxels", "32", "--gradients", "central", "--levels", "1,2,3", "--normals", "limit"))


def ask(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=300)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))} ended with {done.returncode}: {done.stderr}")


def study(limn, scene, sweep, out):
    size = "x".join(map(str, SIZE))
    ask(limn, "study", scene, *sweep, "--views", "1", "--set", f"threshold={THRESHOLD}", "--size", size, "-o", out, "-q")
    return rows.read_cells(out / "rows.csv")


def render(limn, scene, settings, path):
    """The layers of a model's picture, with FACTOR times as many pixels a side as the study's."""
    options = [part for name, value in settings.items() for part in (f"--{name.replace('_', '-')}", value)]
    size = "x".join(str(displacement.FACTOR * side) for side in SIZE)
    ask(limn, "render", scene, *options, "--size", size, "--samples", SAMPLES, "-o", path, "-q")
    layers = read_exr(path, ("A", "NdotV.Y", "id.Y"))
    path.unlink()
    return layers


def measured(truth, layers):
    return {"silhouette": displacement.silhouette(truth["silhouette"], layers),
            "inner": displacement.inner(truth["inner"], layers, THRESHOLD)}


def title(settings):
    return ", ".join([settings["surface"]] + [f"{name} {value}" for name, value in settings.items() if name != "surface"])


def print_line(*columns):
    *cells, verdict = columns
    texts = (f"{cell:.4f}" if isinstance(cell, float) else cell for cell in cells)
    print(" ".join(f"{text:<{width}}" for text, width in zip(texts, WIDTHS)) + " " + verdict, flush=True)


def check_floor(surface, found):
    """What the pictures of the surface itself show: the error of this measurement. True where it is small enough."""
    good = True
    for kind, one in found.items():
        right = one.rms() < FLOOR_PX and one.missing <= MOST_MISSING
        print_line(surface.name, "floor: " + title(surface.floor_model), kind, "rms", "", one.rms(), "",
                   f"{'below' if right else 'NOT BELOW'} {FLOOR_PX} px; {100.0 * one.missing:.1f} % of the border not measured")
        good &= right
    if surface.note():
        print(f"{surface.name}: {surface.note()}")
    return good


def check_model(surface, model, found):
    good = True
    for kind, one in found.items():
        for statistic in STATISTICS:
            limn_px, here_px = model.value(f"{kind}_{statistic}"), float(getattr(one, statistic)())
            # Not so written: NaN does not agree.
            right = abs(here_px - limn_px) <= max(AGREES_SHARE * abs(limn_px), AGREES_PX)
            verdict = "agree" if right else "DISAGREE"
            print_line(surface.name, title(model.settings), kind, statistic, limn_px, here_px, here_px - limn_px, verdict)
            good &= right
    return good


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    limn, folder = (pathlib.Path(part).resolve() for part in sys.argv[1:])
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    verdicts = []
    print_line("surface", "model", "border", "", "limn px", "here px", "difference", "verdict")
    for surface, camera, sweep in cases():
        scene = surface.write_scene(folder, camera)
        truth = {"silhouette": true_border(surface, camera, 0.0), "inner": true_border(surface, camera, THRESHOLD)}

        def found(settings):
            return measured(truth, render(limn, scene, settings, folder / "picture.exr"))

        verdicts.append(check_floor(surface, found(surface.floor_model)))
        for model in study(limn, scene, sweep, folder / surface.name):
            verdicts.append(check_model(surface, model, found(model.settings)))
    print(f"{len(verdicts)} pictures, {verdicts.count(False)} with a number that disagrees")
    return 0 if all(verdicts) else 1


if __name__ == "__main__":
    sys.exit(main())
