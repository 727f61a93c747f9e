#!/usr/bin/env python3
"""A sheet of files drawn with no option: framed by their surface, beside the frame of their bounds' corners that limn had before.

PYTHONPATH=build/release/python /usr/bin/python3 tests/outside/framing_sheet.py FOLDER FILE...

FOLDER/sheet.png has a row of pairs for each two files: before on the left, now on the right. Prints how much of the tighter side the object
fills, how far its middle is from the picture's, and what share of the area it covers; ends with 1 where a file is not within 2 % of 86 %.
"""
import pathlib
import shutil
import subprocess
import sys

import limn
import numpy

SIZE = (1280, 720)


def fill(picture):
    """Share of the tighter side, distance of the middles as a share of the height, covered area. Half a pixel is left to either side."""
    rows, columns = numpy.nonzero(picture.id)
    height, width = picture.id.shape
    low, high = numpy.array([columns.min(), rows.min()]), numpy.array([columns.max(), rows.max()]) + 1
    sides, middle = (high - low) / (width, height), 0.5 * (low + high) - (0.5 * width, 0.5 * height)
    return sides.max(), numpy.abs(middle).max() / height, len(rows) / picture.id.size


def camera_of_box(file):
    """That of the corners of the bounds, with 6 % left on each side."""
    lower, upper = numpy.array(limn.load(file).bounds)
    box = limn.shape("box", half=tuple(numpy.maximum(0.5 * (upper - lower), 1e-9 * numpy.max(upper - lower)))).translate(tuple(0.5 * (lower + upper)))
    return limn.render(box, camera=limn.Camera(margin=0.06), size=SIZE, samples=1).camera


def main():
    folder, files = pathlib.Path(sys.argv[1]), sys.argv[2:]
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    tiles, missed = [], 0
    for number, file in enumerate(files):
        now, before = limn.render(file), limn.render(file, camera=camera_of_box(file), size=SIZE)
        for name, picture in (("before", before), ("now", now)):
            tiles.append(folder / f"{number:02}-{name}.png")
            picture.write(tiles[-1])
        share, away, area = fill(now)
        old_share, old_away, old_area = fill(before)
        fine = abs(share - 0.86) <= 0.02 * 0.86
        missed += not fine
        print(f"{pathlib.Path(file).name:28} fills {100 * share:5.1f} % (before {100 * old_share:5.1f}), {100 * away:4.1f} % off the middle ({100 * old_away:4.1f}), "
              f"covers {100 * area:4.1f} % ({100 * old_area:4.1f}){'' if fine else '  WRONG'}", flush=True)
    small = [word for tile in tiles for word in (tile, "--resize", "320x180")]
    subprocess.run(["oiiotool", *small, f"--mosaic:pad=4", f"4x{(len(tiles) + 3) // 4}", "-o", folder / "sheet.png"], check=True)
    print(folder / "sheet.png")
    sys.exit(1 if missed else 0)


if __name__ == "__main__":
    main()
