"""What the tests of the Python module share: the program they compare it with, folders that go away, seeds."""

import os
import random
import subprocess
import tempfile
import unittest

import numpy

PROGRAM = os.environ["LIMN_PROGRAM"]


class TestCase(unittest.TestCase):
    """With a folder of its own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="limn-test-")
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def file(self, name):
        return os.path.join(self.folder, name)

    def program(self, *arguments):
        """What the command line prints on stdout."""
        done = subprocess.run([PROGRAM, *arguments, "--quiet"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def assertSameBits(self, a, b):
        """Equal to the last bit, NaN included."""
        a, b = numpy.ascontiguousarray(a), numpy.ascontiguousarray(b)
        self.assertEqual((a.shape, a.dtype), (b.shape, b.dtype))
        self.assertEqual(a.tobytes(), b.tobytes())


def random_numbers():
    """A generator whose seed is printed; LIMN_SEED repeats it."""
    seed = int(os.environ.get("LIMN_SEED") or random.SystemRandom().randrange(2**31))
    print(f"LIMN_SEED={seed}")
    return numpy.random.default_rng(seed)
