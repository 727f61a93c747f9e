#!/usr/bin/env python3
"""The Blender script, in Blender without a display, and limn's .exr files in its compositor: blender_test.py LIMN FOLDER [--compositor]
Ends with 77 where Blender or oiiotool is not installed.
"""
import os
import pathlib
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
SCRIPTS = ROOT / "samples" / "blender"
# Blender takes the standard library of the first Python on the PATH: Debian's, which has numpy.
ENVIRONMENT = os.environ | {"PATH": f"/usr/bin:{os.environ.get('PATH', '')}"}


def compositor(blender, limn, folder):
    if not shutil.which("oiiotool"):
        print("skipped: no oiiotool; the package openimageio-tools brings it")
        sys.exit(77)
    picture = folder / "picture.exr"
    subprocess.run([limn, "render", ROOT / "samples" / "scenes" / "still_life.toml", "--size", "160x120", "-q", "-o", picture], check=True)
    done = subprocess.run([blender, "-b", "--factory-startup", "--python-exit-code", "1", "--python", HERE / "in_compositor.py", "--", picture, folder],
                          env=ENVIRONMENT, capture_output=True, text=True, timeout=600)
    print("\n".join(line for line in done.stdout.splitlines() if line.startswith(("compositor:", "in the"))))
    if done.returncode != 0 or "in the compositor: all held" not in done.stdout:
        print(done.stdout[-2000:], done.stderr[-4000:])
        sys.exit(1)


def main():
    limn, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    blender = shutil.which("blender")
    if not blender:
        print("skipped: no Blender; the package blender brings it")
        sys.exit(77)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    if "--compositor" in sys.argv:
        return compositor(blender, limn, folder)
    done = subprocess.run([blender, "-b", "--factory-startup", "--python-exit-code", "1", "--python", HERE / "in_blender.py", "--", limn, folder, SCRIPTS],
                          env=ENVIRONMENT, capture_output=True, text=True, timeout=900)
    said = [line for line in done.stdout.splitlines() if line.startswith(("perspective", "vertical", "orthographic", "in Blender"))]
    print("\n".join(said))
    if done.returncode != 0 or "in Blender: all held" not in said:
        print(done.stdout[-2000:], done.stderr[-4000:])
        sys.exit(1)
    # As from a shell, with the scene that Blender starts with.
    call = subprocess.run([blender, "-b", "--factory-startup", "--python-exit-code", "1", "--python", SCRIPTS / "limn_lines.py", "--", "--limn", limn,
                           "--out", folder / "call", "--save", folder / "lines.blend"], env=ENVIRONMENT, capture_output=True, text=True, timeout=600)
    print("\n".join(line for line in call.stdout.splitlines() if line.startswith("limn:")))
    if call.returncode != 0 or not (folder / "lines.blend").exists() or not (folder / "call" / "lines.svg").exists():
        print(call.stdout[-2000:], call.stderr[-2000:])
        sys.exit(1)


if __name__ == "__main__":
    main()
