"""A picture of 1920 x 1080 from Python beside the same from C++ (limn-python-bench), by turns: medians, and their ratio.

    PYTHONPATH=build/release/python /usr/bin/python3 tests/python/bench.py build/release/limn-python-bench [SCENE [ROUNDS]]
"""

import statistics
import subprocess
import sys
import time

import limn

PICTURES = 5


def in_cpp(program, scene):
    done = subprocess.run([program, scene, str(PICTURES)], capture_output=True, text=True, check=True)
    return [tuple(float(word) for word in line.split()) for line in done.stdout.splitlines()][1:]


def in_python(model):
    times = []
    for _ in range(PICTURES):
        start, before = time.perf_counter(), time.process_time()
        limn.render(model, size=(1920, 1080))
        times.append((1e3 * (time.perf_counter() - start), 1e3 * (time.process_time() - before)))
    return times[1:]


def main():
    program = sys.argv[1]
    scene = sys.argv[2] if len(sys.argv) > 2 else "gyroid"
    rounds = int(sys.argv[3]) if len(sys.argv) > 3 else 5
    model = limn.model(scene)
    cpp, python = [], []
    for _ in range(rounds):
        cpp += in_cpp(program, scene)
        python += in_python(model)
    for index, what in enumerate(("wall clock", "processor")):
        a, b = (statistics.median(times[index] for times in both) for both in (cpp, python))
        best_a, best_b = (min(times[index] for times in both) for both in (cpp, python))
        print(f"{scene}, {what}: C++ {a:.1f} ms, Python {b:.1f} ms, ratio {b / a:.3f}; least {best_a:.1f} and {best_b:.1f} ms, {best_b / best_a:.3f}")


if __name__ == "__main__":
    main()
