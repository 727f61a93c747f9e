"""The stub of the extension module has what the module has, and the package's types fit together."""

import inspect
import os
import shutil
import subprocess
import sys
import unittest

import limn
from limn_test import TestCase

PACKAGE = os.path.dirname(limn.__file__)
ALLOWED = os.path.join(os.path.dirname(os.path.abspath(__file__)), "stub_allowlist.txt")


def checked(*arguments):
    """What mypy says of the package in the build tree."""
    environment = {**os.environ, "MYPYPATH": os.path.dirname(PACKAGE)}
    return subprocess.run(arguments, capture_output=True, text=True, check=False, env=environment)


class Types(TestCase):
    def setUp(self):
        super().setUp()
        if shutil.which("mypy", path="/usr/bin") is None:
            self.skipTest("no mypy; the package mypy brings it")
        self.cache = self.file("cache")

    def test_the_stub_is_that_of_the_module(self):
        done = checked("/usr/bin/stubtest", "limn._limn", "--ignore-missing-stub", "--allowlist", ALLOWED)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_the_package_fits_its_types(self):
        done = checked("/usr/bin/mypy", "--cache-dir", self.cache, "-p", "limn")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_a_callers_mistake_is_found(self):
        with open(self.file("caller.py"), "w", encoding="utf-8") as file:
            file.write('import limn\nlimn.render("teacup", size=(1, 2)).depht\nlimn.render("teacup", voxles=3)\nlimn.contours("rook").chains[0].px\n')
        done = checked("/usr/bin/mypy", "--cache-dir", self.cache, self.file("caller.py"))
        self.assertIn('"Picture" has no attribute "depht"', done.stdout)
        self.assertIn('"voxles"', done.stdout)
        self.assertIn("Found 2 errors", done.stdout)


class Help(TestCase):
    def test_everything_public_has_a_docstring(self):
        lacking = []
        for name in limn.__all__:
            one = getattr(limn, name)
            if isinstance(one, str):
                continue
            if not inspect.getdoc(one):
                lacking.append(name)
            if not inspect.isclass(one):
                continue
            for member, value in vars(one).items():
                described = isinstance(value, property) or inspect.isroutine(value) and not isinstance(value, (staticmethod, classmethod))
                if not member.startswith("_") and described and not inspect.getdoc(value):
                    lacking.append(f"{name}.{member}")
        self.assertEqual(lacking, [])

    def test_arguments_are_explained_where_they_are_taken(self):
        for function in (limn.render, limn.model, limn.contours, limn.truth, limn.border, limn.measure, limn.compare, limn.study, limn.plan,
                         limn.judge):
            self.assertGreater(len(inspect.getdoc(function)), 150, function.__name__)

    def test_every_name_is_there(self):
        self.assertEqual(sorted(limn.__all__), limn.__all__)
        for kind in ("shapes", "surfaces", "gradients", "methods", "metrics", "scenes", "lines"):
            self.assertTrue(limn.names(kind))
        self.assertEqual(sys.modules["limn"].__version__, limn.__version__)


if __name__ == "__main__":
    unittest.main()
