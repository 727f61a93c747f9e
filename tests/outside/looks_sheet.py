#!/usr/bin/env python3
"""Every look on every model, on one sheet: looks_sheet.py LIMN FOLDER [MODEL...]. FOLDER/sheet.png has a row for each look."""
import pathlib
import re
import shutil
import subprocess
import sys

MODELS = ("teacup", "rook", "machined_part", "gyroid", "pipe_junction")


def main():
    limn, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    models = sys.argv[3:] or MODELS
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    listed = subprocess.run([limn, "list", "looks"], check=True, capture_output=True, text=True).stdout
    looks, tiles = re.findall(r"(?m)^([a-z_]+) ", listed), []
    for look in looks:
        for model in models:
            tiles.append(folder / f"{look}-{pathlib.Path(model).stem}.png")
            subprocess.run([limn, "render", model, "--look", look, "--size", "960x720", "-q", "-o", tiles[-1]], check=True)
    small = [word for tile in tiles for word in (tile, "--resize", "380x285")]
    subprocess.run(["oiiotool", *small, "--mosaic:pad=4", f"{len(models)}x{len(looks)}", "-o", folder / "sheet.png"], check=True)
    print(folder / "sheet.png")


if __name__ == "__main__":
    main()
