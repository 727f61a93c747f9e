"""The built-in scenes, and how a check of several of them is called."""
import pathlib
import shutil
import sys

ALL = ("ellipsoid", "tilted_torus", "machined_part", "superellipsoid", "gyroid", "teacup", "rook", "pipe_junction", "bracket")


def arguments(usage, quick):
    """CHECK LIMN FOLDER [SCENE...]: the program, an empty folder, and the scenes: those of `quick` where none is given, all for "all"."""
    if len(sys.argv) < 3:
        sys.exit(usage)
    limn, folder = (pathlib.Path(part).resolve() for part in sys.argv[1:3])
    scenes = sys.argv[3:] or quick
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return limn, folder, ALL if scenes == ["all"] else scenes
