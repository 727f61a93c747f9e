#!/usr/bin/env python3
"""The Blender script, in Blender without a display: blender_test.py LIMN FOLDER. Ends with 77 where Blender is not installed."""
import pathlib
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
SCRIPTS = HERE.parent.parent / "samples" / "blender"


def main():
    limn, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    blender = shutil.which("blender")
    if not blender:
        print("skipped: no Blender; the package blender brings it")
        sys.exit(77)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    done = subprocess.run([blender, "-b", "--factory-startup", "--python-exit-code", "1", "--python", HERE / "in_blender.py", "--", limn, folder, SCRIPTS],
                          capture_output=True, text=True, timeout=900)
    said = [line for line in done.stdout.splitlines() if line.startswith(("perspective", "vertical", "orthographic", "in Blender"))]
    print("\n".join(said))
    if done.returncode != 0 or "in Blender: all held" not in said:
        print(done.stdout[-2000:], done.stderr[-4000:])
        sys.exit(1)
    # As from a shell, with the scene that Blender starts with.
    call = subprocess.run([blender, "-b", "--factory-startup", "--python-exit-code", "1", "--python", SCRIPTS / "limn_lines.py", "--", "--limn", limn,
                           "--out", folder / "call", "--save", folder / "lines.blend"], capture_output=True, text=True, timeout=600)
    print("\n".join(line for line in call.stdout.splitlines() if line.startswith("limn:")))
    if call.returncode != 0 or not (folder / "lines.blend").exists() or not (folder / "call" / "lines.svg").exists():
        print(call.stdout[-2000:], call.stderr[-2000:])
        sys.exit(1)


if __name__ == "__main__":
    main()
