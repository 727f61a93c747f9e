"""What a caller gets wrong raises, and never ends the program: every argument of every function gets every kind of wrong value."""

import inspect
import os
import subprocess
import sys
import unittest

import limn
import numpy
from limn_test import PROGRAM, TestCase

WRONG = [
    None,
    "",
    "no such thing",
    "\0",
    b"bytes",
    -1,
    0,
    2.5,
    1e300,
    float("nan"),
    float("inf"),
    2**70,
    True,
    [],
    [None],
    {},
    {"a": 1},
    object(),
    ValueError,
    lambda *given: given[7],
    numpy.array(["x"]),
    numpy.zeros((0, 3)),
    numpy.full((2, 3), numpy.nan),
    numpy.zeros((2, 2, 2), dtype=complex),
    limn.Camera(eye=(0, 0, 0), target=(0, 0, 0), size=(16, 12)),
    limn.Camera(size=(0, 0)),
    limn.shape("plane"),
    limn.shape("sphere", radius=1e-9),
]

BALL = limn.shape("sphere")
# Small enough that an accepted value costs nothing.
GIVEN = {
    limn.render: dict(scene=BALL, size=(16, 12)),
    limn.model: dict(scene=BALL, size=(16, 12)),
    limn.contours: dict(scene=BALL, size=(16, 12)),
    limn.truth: dict(scene=BALL, size=(16, 12)),
    limn.border: dict(scene=BALL, size=(16, 12)),
    limn.measure: dict(scene=BALL, size=(16, 12)),
    limn.judge: dict(drawing=numpy.eye(16), against=BALL),
    limn.scene: dict(objects=[BALL]),
    limn.load: dict(file="ellipsoid"),
    limn.names: dict(kind="shapes"),
    limn.shape: dict(name="sphere"),
    limn.field: dict(function=lambda x, y, z: x * x + y * y + z * z - 1, bounds=[(-2,) * 3, (2,) * 3], lipschitz=4),
    limn.formula: dict(function=lambda x, y, z: x * x + y * y + z * z - 1),
    limn.field_from_grid: dict(values=numpy.ones((3, 3, 3)), origin=(0, 0, 0), spacing=1),
    limn.level_set: dict(source=BALL, voxels=16),
    limn.level_set_from_array: dict(values=numpy.ones((3, 3, 3)), voxel_size=1),
    limn.level_set_from_voxels: dict(indices=[[0, 0, 0]], values=[0.5], voxel_size=1),
    limn.mesh_from_triangles: dict(positions=numpy.eye(3), triangles=[[0, 1, 2]]),
    limn.read_mesh: dict(file="none.obj"),
    limn.read_level_set: dict(file="none.vdb"),
    limn.read_channel: dict(file="none.exr", channel="Z"),
    limn.channel_names: dict(file="none.exr"),
    limn.tessellate: dict(field=BALL, level=0),
}
# Ranges that are no mistake, and only slow.
SLOW = {"samples", "level", "voxels", "views", "half_width", "tolerance_px", "max_memory"}


def tried():
    """Function, argument and wrong value, one after the other."""
    for function, given in GIVEN.items():
        for name in inspect.signature(function).parameters:
            for wrong in WRONG:
                if name in SLOW and isinstance(wrong, (int, float)) and not isinstance(wrong, bool):
                    continue
                yield function, {**given, name: wrong}, name, wrong


def try_all():
    """In a process of its own: what crashes takes that down, and the last line says what it was."""
    raised = 0
    for function, arguments, name, wrong in tried():
        print(f"{function.__name__}({name}={wrong!r})", flush=True)
        try:
            function(**arguments)
        except (limn.InputError, TypeError, ValueError, AttributeError, IndexError):
            raised += 1
    print("raised", raised)


class WrongArguments(TestCase):
    def test_they_raise(self):
        done = subprocess.run([sys.executable, __file__, "--try-all"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout[-300:] + done.stderr[-3000:])
        self.assertGreater(int(done.stdout.split()[-1]), 1500)

    def test_messages_are_those_of_the_command_line(self):
        for words, call, flag in (
            (["--voxels", "3"], dict(voxels=3), "voxels"),
            (["--size", "0x5"], dict(size=(0, 5)), "size"),
            (["--samples", "2000"], dict(samples=2000), "samples"),
            (["--method", "rin"], dict(methods="rin"), "method"),
            (["--set", "treshold=1"], dict(parameters={"treshold": 1}), ""),
            (["--set", "threshold=7"], dict(parameters={"threshold": 7}), ""),
            (["--background", "whit"], dict(background="whit"), "background"),
            (["--fov", "200"], dict(camera=limn.Camera(fov=200)), "fov"),
            (["--gradient", "cubic"], dict(gradient="cubic"), "gradient"),
            (["--surface", "grid"], dict(surface="grid"), "surface"),
            (["--level", "9"], dict(level=9), "level"),
            (["--half-width", "1"], dict(half_width=1), "half_width"),
        ):
            with self.subTest(words):
                done = subprocess.run([PROGRAM, "render", "gyroid", *words, "-o", self.file("x.png")], capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, 2)
                with self.assertRaises(limn.InputError) as caught:
                    limn.render("gyroid", **call)
                # The option's name is the argument's, and settings are named as arguments: that apart they say the same.
                theirs = done.stderr.strip().removeprefix("limn: ")
                ours = str(caught.exception)
                self.assertEqual(theirs.split(": ", 1)[1].replace("--", ""), ours.split(": ", 1)[1].replace(" = ", " "), (theirs, ours))
                self.assertIsInstance(caught.exception, ValueError)
                if flag:
                    self.assertEqual(caught.exception.field, flag)

    def test_a_file_that_is_not_there_is_named(self):
        with self.assertRaises(limn.InputError) as caught:
            limn.render(self.file("cow.obj"))
        self.assertIn("no such file", str(caught.exception))
        self.assertEqual(caught.exception.file, self.file("cow.obj"))

    def test_a_damaged_file_raises(self):
        with open(self.file("bad.vdb"), "wb") as file:
            file.write(b"\x20BDV\0\0\0\0" + bytes(200))
        with open(self.file("bad.toml"), "w", encoding="utf-8") as file:
            file.write("[[object]]\nshape = 'sphere'\nradios = 2\n")
        for name in ("bad.vdb", "bad.toml"):
            with self.assertRaises(limn.InputError) as caught:
                limn.render(self.file(name))
            # A scene file's line and column are part of the place.
            self.assertEqual(caught.exception.file.removeprefix(self.file(name)).strip(":0123456789"), "")

    def test_what_cannot_be_written_raises_and_leaves_nothing(self):
        picture = limn.render(BALL, size=(16, 12))
        for name in ("none/at/all.txt", "picture.xyz", "picture"):
            with self.assertRaises(limn.InputError):
                picture.write(self.file(name))
        os.mkdir(self.file("folder.png"))
        with self.assertRaises(limn.InputError):
            picture.write(self.file("folder.png"))
        self.assertEqual(os.listdir(self.folder), ["folder.png"])

    def test_a_model_too_large_for_the_memory_is_refused(self):
        with self.assertRaisesRegex(limn.InputError, "needs about"):
            limn.render("gyroid", surface="level_set", voxels=8000, max_memory="500M", size=(16, 12))

    def test_errors_have_their_parts(self):
        with self.assertRaises(limn.InputError) as caught:
            limn.render("gyroid", voxels=3)
        self.assertEqual(caught.exception.value, "3")
        self.assertEqual(caught.exception.expected, "a whole number from 4 to 8192")
        self.assertTrue(issubclass(limn.MachineError, RuntimeError))


if __name__ == "__main__":
    if "--try-all" in sys.argv:
        try_all()
    else:
        unittest.main()
