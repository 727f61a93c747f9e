"""How calls behave: arrays without copies, the interpreter's lock, Ctrl-C, memory."""

import gc
import os
import signal
import subprocess
import sys
import threading
import time
import unittest

import limn
import numpy
from limn_test import TestCase


def resident_bytes():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


class Arrays(TestCase):
    LAYERS = {
        "depth": ("f4", ()),
        "position": ("f4", (3,)),
        "normal": ("f4", (3,)),
        "n_dot_v": ("f4", ()),
        "id": ("i4", ()),
        "material": ("i4", ()),
        "face": ("i4", ()),
        "status": ("u1", ()),
        "border": ("f4", ()),
        "composite": ("f4", (4,)),
    }

    def test_layers_look_at_the_picture(self):
        picture = limn.render("ellipsoid", size=(40, 30))
        for name, (kind, more) in self.LAYERS.items():
            layer = getattr(picture, name)
            self.assertEqual((layer.dtype, layer.shape), (numpy.dtype(kind), (30, 40, *more)), name)
            self.assertIs(layer.base, picture)
            self.assertTrue(layer.flags.c_contiguous)
            self.assertFalse(layer.flags.owndata)
            with self.assertRaises(ValueError):
                layer[0, 0] = 1
            again = getattr(picture, name)
            self.assertEqual(layer.__array_interface__["data"][0], again.__array_interface__["data"][0])

    def test_layers_outlive_their_picture(self):
        layer = limn.render("ellipsoid", size=(400, 300)).normal
        kept = layer.copy()
        for _ in range(3):
            gc.collect()
            limn.render("gyroid", size=(400, 300))
        self.assertSameBits(layer, kept)

    def test_chains_and_curves_outlive_what_they_are_of(self):
        px = limn.contours("ellipsoid", size=(80, 60)).chains[0].px
        curve = limn.truth("ellipsoid", size=(80, 60)).curves[0].px
        kept = px.copy(), curve.copy()
        gc.collect()
        limn.contours("gyroid", size=(80, 60))
        self.assertSameBits(px, kept[0])
        self.assertSameBits(curve, kept[1])

    def test_pictures_are_shown_by_notebooks(self):
        png = limn.render("ellipsoid", size=(40, 30))._repr_png_()
        self.assertEqual(png[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual((int.from_bytes(png[16:20], "big"), int.from_bytes(png[20:24], "big")), (40, 30))
        svg = limn.contours("ellipsoid", size=(40, 30))._repr_svg_()
        self.assertIn("<svg", svg)
        self.assertIn('viewBox="0 0 40 30"', svg)


class Lock(TestCase):
    def test_other_threads_run_meanwhile(self):
        counted, stop = [0], threading.Event()

        def count():
            while not stop.is_set():
                counted[0] += 1
                time.sleep(0.001)

        thread = threading.Thread(target=count)
        thread.start()
        try:
            before = counted[0]
            limn.truth("gyroid", size=(200, 150))
            during = counted[0] - before
        finally:
            stop.set()
            thread.join()
        # With the lock held the thread could count once, before and after.
        self.assertGreater(during, 10)

    def test_several_threads_draw_at_a_time(self):
        expected = limn.render("gyroid", size=(60, 40), samples=1).composite
        drawn = []
        threads = [threading.Thread(target=lambda: drawn.append(limn.render("gyroid", size=(60, 40), samples=1).composite)) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(drawn), 4)
        for picture in drawn:
            self.assertSameBits(picture, expected)


INTERRUPTED = """
import limn, math, signal, sys, threading, time, os
def work():
    {work}
print("ready", flush=True)
try:
    while True:
        work()
except KeyboardInterrupt:
    print("stopped", flush=True)
print(limn.render("ellipsoid", size=(8, 6)).hits >= 0)
"""


class Interrupts(TestCase):
    WORK = {
        "pictures": 'limn.render("gyroid", size=(1600, 1200), samples=1024)',
        "level sets": 'limn.level_set(limn.shape("gyroid"), voxels=1500)',
        "callables": 'limn.render(limn.field(lambda x, y, z: math.sqrt(x*x+y*y+z*z)-1, bounds=[(-2,)*3, (2,)*3], lipschitz=1), size=(900, 900), samples=1, camera=limn.Camera(eye=(0, 0, 5), target=(0, 0, 0)))',
        "truth": 'limn.truth("gyroid", size=(1920, 1080), views=20, view=7)',
        "studies": 'limn.study("gyroid", size=(640, 480), views=50)',
        "comparisons": 'limn.compare("gyroid", methods="all", size=(1280, 720), samples=64)',
    }

    def test_an_interrupt_stops_the_work_and_no_more(self):
        processes = {name: subprocess.Popen([sys.executable, "-c", INTERRUPTED.format(work=work)], stdout=subprocess.PIPE,
                                            stderr=subprocess.PIPE, text=True) for name, work in self.WORK.items()}
        for process in processes.values():
            self.assertEqual(process.stdout.readline(), "ready\n")
        time.sleep(1.5)
        for process in processes.values():
            process.send_signal(signal.SIGINT)
        for name, process in processes.items():
            with self.subTest(name):
                # No bound on time but that of patience: the work itself would take minutes or never end.
                out, err = process.communicate(timeout=120)
                self.assertEqual((out, process.returncode), ("stopped\nTrue\n", 0), err)

    def test_a_handler_that_does_not_raise_stops_nothing(self):
        seen = []
        before = signal.signal(signal.SIGALRM, lambda *_: seen.append(1))
        try:
            signal.setitimer(signal.ITIMER_REAL, 0.05, 0.05)
            picture = limn.render("gyroid", size=(400, 300), samples=8)
            while not seen:
                picture = limn.render("gyroid", size=(400, 300), samples=8)
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, before)
        self.assertSameBits(picture.composite, limn.render("gyroid", size=(400, 300), samples=8).composite)


class Memory(TestCase):
    def leaked(self, work, times, warm):
        """Bytes that stay resident, call by call, after the first `warm`."""
        for _ in range(warm):
            work()
        gc.collect()
        before = resident_bytes()
        for _ in range(times):
            work()
        gc.collect()
        return (resident_bytes() - before) / times

    def test_a_thousand_pictures_leave_nothing(self):
        size = (160, 120)
        one = sum(getattr(limn.render("ellipsoid", size=size, samples=1), name).nbytes for name in Arrays.LAYERS)
        # Were one picture of a hundred kept, this would be exceeded; what the allocator keeps is less.
        self.assertLess(self.leaked(lambda: limn.render("ellipsoid", size=size, samples=1).normal, 1000, 100), one / 100)

    def test_errors_leave_nothing(self):
        def fails():
            try:
                limn.render("ellipsoid", voxels=3)
            except limn.InputError:
                return
            raise AssertionError("it was not refused")

        self.assertLess(self.leaked(fails, 5000, 500), 100)

    def test_callables_are_let_go(self):
        class Function:
            def __call__(self, x, y, z):
                return x * x + y * y + z * z - 1

        function = Function()
        before = sys.getrefcount(function)
        field = limn.field(function, bounds=[(-2,) * 3, (2,) * 3], lipschitz=4)
        field.values(numpy.zeros((100, 3)))
        self.assertGreater(sys.getrefcount(function), before)
        del field
        gc.collect()
        self.assertEqual(sys.getrefcount(function), before)


if __name__ == "__main__":
    unittest.main()
