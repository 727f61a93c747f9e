#!/usr/bin/env python3
"""The packages that `./run package` writes, in a bare Debian: lintian finds no errors; they install with what they depend on; the demo is
drawn, man pages and completion are where they are looked for, a C++ project finds the libraries and Python its module; after they are purged
no file is left that was not there before.

install_test.py PACKAGES WORK CONSUMER [--json FILE]

Needs root, debootstrap, lintian and a mirror of Debian's packages. WORK/base is made once and kept. CONSUMER: the project that is built
against the libraries. Ends with 77 where something of this is missing.
"""
import argparse
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import time

FAILURES = []
FIGURES = {}
# What apt, dpkg and others write on every machine, whatever is installed.
NOT_OURS = re.compile(r"^(var/(cache|log|lib/(apt|dpkg|systemd))/|run/|proc/|sys/|dev/|tmp/|etc/(ld\.so\.cache|apt/)|root/)")


def check(fine, text):
    if not fine:
        FAILURES.append(text)
        print(f"wrong: {text}", flush=True)


def skip(text):
    print(f"skipped: {text}")
    sys.exit(77)


def run(*command, **options):
    return subprocess.run([str(c) for c in command], capture_output=True, text=True, errors="replace", **options)


def must(*command, **options):
    done = run(*command, **options)
    if done.returncode != 0:
        raise SystemExit(f"failed ({done.returncode}): {' '.join(map(str, command))}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}")
    return done.stdout


class Root:
    """A bare Debian in a folder, with packages from where this machine has its own."""

    def __init__(self, work):
        base, self.path = work / "base", work / "root"
        if not (base / "ready").exists():
            shutil.rmtree(base, ignore_errors=True)
            must("debootstrap", "--variant=minbase", "--include=ca-certificates", "bookworm", base, *mirror())
            (base / "ready").touch()
        self.unmount()
        shutil.rmtree(self.path, ignore_errors=True)
        must("cp", "-a", base, self.path)
        (self.path / "ready").unlink()
        for file in ("etc/resolv.conf", "etc/hosts"):
            shutil.copy(pathlib.Path("/") / file, self.path / file)
        (self.path / "usr/sbin/policy-rc.d").write_text("#!/bin/sh\nexit 101\n")
        (self.path / "usr/sbin/policy-rc.d").chmod(0o755)

    def __enter__(self):
        for kind, place in (("proc", "proc"), ("sysfs", "sys")):
            must("mount", "-t", kind, kind, self.path / place)
        must("mount", "--bind", "/dev", self.path / "dev")
        return self

    def __exit__(self, *_):
        self.unmount()

    def unmount(self):
        for place in ("dev", "sys", "proc"):
            if os.path.ismount(self.path / place):
                must("umount", "-l", self.path / place)

    def call(self, script):
        environment = {key: value for key, value in os.environ.items() if "proxy" in key.lower() or key.startswith("SSL_")}
        environment |= {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "HOME": "/root", "LC_ALL": "C.UTF-8", "DEBIAN_FRONTEND": "noninteractive"}
        return run("chroot", self.path, "sh", "-c", script, env=environment)

    def must(self, script):
        done = self.call(script)
        if done.returncode != 0:
            raise SystemExit(f"failed in the bare Debian ({done.returncode}): {script}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}")
        return done.stdout

    def files(self):
        """Every file and link, but those that apt and dpkg write by themselves."""
        found = set()
        for folder, folders, names in os.walk(self.path):
            inside = os.path.relpath(folder, self.path)
            if inside in ("proc", "sys", "dev", "tmp"):
                folders.clear()
                continue
            found.update(os.path.normpath(os.path.join(inside, name)) for name in names + [f for f in folders])
        return {name for name in found if not NOT_OURS.match(name)}


def mirror():
    """The address that this machine has its own packages of bookworm from; other programs' archives stand in the same folder."""
    files = [pathlib.Path("/etc/apt/sources.list"), *sorted(pathlib.Path("/etc/apt/sources.list.d").glob("*"))]
    for text in [file.read_text() for file in files if file.is_file()]:
        for address, suite in re.findall(r"(?m)^deb\s+(?:\[[^]]*\]\s+)?(\S+)\s+(\S+)", text):
            if suite == "bookworm":
                return [address]
        for part in re.split(r"\n\s*\n", text):
            found, suites = re.search(r"(?m)^URIs:\s*(\S+)", part), re.search(r"(?m)^Suites:\s*(.*)", part)
            if found and suites and "bookworm" in suites[1].split():
                return [found[1]]
    return []


def check_program(root):
    start = time.monotonic()
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = root.call("cd /tmp && limn demo -o demo")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    FIGURES["demo_s"] = round(time.monotonic() - start, 1)
    FIGURES["demo_processor_s"] = round(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, 1)
    print(f"limn demo: {FIGURES['demo_s']} s, {FIGURES['demo_processor_s']} s of processors", flush=True)
    check(done.returncode == 0, f"limn demo: {done.stderr}")
    page = root.path / "tmp/demo/index.html"
    check(page.exists(), "limn demo wrote no page")
    if page.exists():
        for name in re.findall(r'(?:src|href)="([^"]*)"', page.read_text()):
            check((page.parent / name).stat().st_size > 0, f"the demo's {name} is empty")
    # Each by another helper program or late module: EXR, VDB, glTF's reader, SVG.
    (root.path / "tmp/cube.off").write_text("OFF\n8 6 0\n-1 -1 -1\n1 -1 -1\n1 1 -1\n-1 1 -1\n-1 -1 1\n1 -1 1\n1 1 1\n-1 1 1\n"
                                            "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n")
    for call in ("render gyroid --size 64x48 -o g.exr", "info g.exr", "export gyroid --voxels 32 -o g.vdb", "render g.vdb --size 64x48 -o v.jpg",
                 "contours cube.off -o c.svg", "judge c.svg --against cube.off", "list methods"):
        done = root.call(f"cd /tmp && limn {call}")
        check(done.returncode == 0, f"limn {call}: {done.returncode}, {done.stderr}")
    for file in ("share/man/man1/limn-render.1.gz", "share/bash-completion/completions/limn", "share/zsh/vendor-completions/_limn",
                 "share/fish/vendor_completions.d/limn.fish", "share/doc/limn/copyright"):
        check((root.path / "usr" / file).exists(), f"/usr/{file} is not there")
    done = root.call("cd /tmp && bash -c 'source /usr/share/bash-completion/completions/limn; COMP_WORDS=(limn re); COMP_CWORD=1; _limn; echo $COMPREPLY'")
    check(done.stdout.strip() == "render", f"completion gives {done.stdout!r}")


def check_libraries(root, consumer):
    shutil.copytree(consumer, root.path / "tmp/consumer", dirs_exist_ok=True)
    root.must("apt-get -q install -y --no-install-recommends g++ cmake ninja-build")
    root.must("cmake -S /tmp/consumer -B /tmp/consumer/build -G Ninja -DCMAKE_BUILD_TYPE=Release && cmake --build /tmp/consumer/build")
    for program in ("consumer", "experiment", "border"):
        done = root.call(f"cd /tmp && /tmp/consumer/build/{program}")
        check(done.returncode == 0, f"{program} of the consumer: {done.stderr}")


# Each by what the module looks for beside itself: pictures, level sets, files read by helper programs, the same bytes as the program's.
PYTHON = """
import numpy, subprocess, limn
picture = limn.render("teacup", size=(96, 72))
picture.write("python.png")
subprocess.run(["limn", "render", "teacup", "--size", "96x72", "-q", "-o", "program.png"], check=True)
assert open("python.png", "rb").read() == open("program.png", "rb").read()
picture.write("python.exr")
assert numpy.array_equal(limn.read_channel("python.exr", "Z"), picture.depth)
assert limn.render("gyroid", surface="level_set", voxels=32, size=(64, 48)).id.any()
assert limn.render("cube.off", size=(64, 48)).id.any()
assert "<svg" in limn.contours("cube.off", size=(64, 48))._repr_svg_()
print(limn.__version__, "renders as the program does")
"""


def check_python(root):
    (root.path / "tmp/check.py").write_text(PYTHON)
    done = root.call("cd /tmp && /usr/bin/python3 check.py")
    check(done.returncode == 0, f"Python: {done.stderr}")
    print(f"import limn: {done.stdout.strip()}", flush=True)


def names_of(packages):
    return [must("dpkg-deb", "-f", file, "Package").strip() for file in packages]


def install(root, packages):
    for file in packages:
        shutil.copy(file, root.path / "tmp")
    root.must("apt-get -q update")
    start = time.monotonic()
    before = root.files()
    root.must("apt-get -q install -y --no-install-recommends " + " ".join(f"/tmp/{file.name}" for file in packages))
    FIGURES["install_s"] = round(time.monotonic() - start, 1)
    added = len(root.files() - before)
    FIGURES["files_installed"] = added
    print(f"installed in {FIGURES['install_s']} s: {added} files and folders, with all that they depend on", flush=True)
    return before


def purge(root, names, before, extra):
    root.must("apt-get -q purge -y " + " ".join(names + extra) + " && apt-get -q autoremove --purge -y")
    root.must("rm -rf /tmp/* ")
    left = sorted(root.files() - before)
    FIGURES["files_left"] = len(left)
    print(f"purged: {len(left)} files and folders are left", flush=True)
    check(not left, f"left after the purge: {left[:20]}")
    gone = sorted(before - root.files())
    check(not gone, f"gone with the purge: {gone[:20]}")
    for name in names:
        check(root.call(f"dpkg -s {name}").returncode != 0, f"dpkg still knows {name}")


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("packages", type=pathlib.Path)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("consumer", type=pathlib.Path)
    parser.add_argument("--json", type=pathlib.Path)
    options = parser.parse_args()
    if os.geteuid() != 0:
        skip("installing packages in a bare Debian needs root")
    for program in ("debootstrap", "lintian"):
        if not shutil.which(program):
            skip(f"no {program}; the package {program} brings it")
    packages = sorted(options.packages.resolve().glob("*.deb"))
    names = names_of(packages)
    check(set(names) == {"limn", "liblimn-dev", "limn-doc", "python3-limn"}, f"there are the packages {names}, expected all four")
    lint = run("lintian", "--allow-root", "--fail-on", "error", *packages)
    FIGURES["lintian_errors"] = sum(line.startswith("E:") for line in lint.stdout.splitlines())
    print(f"lintian: {FIGURES['lintian_errors']} errors, {sum(line.startswith('W:') for line in lint.stdout.splitlines())} warnings", flush=True)
    check(lint.returncode == 0, f"lintian: {lint.stdout}")
    options.work.mkdir(parents=True, exist_ok=True)
    with Root(options.work.resolve()) as root:
        before = install(root, packages)
        check_program(root)
        check_python(root)
        check_libraries(root, options.consumer)
        purge(root, names, before, ["g++", "cmake", "ninja-build"])
    shutil.rmtree(options.work / "root", ignore_errors=True)
    if options.json:
        options.json.write_text(json.dumps({"packages": names, "figures": FIGURES, "failures": FAILURES}, indent=1) + "\n")
    print(f"{len(FAILURES)} failures")
    sys.exit(1 if FAILURES else 0)


if __name__ == "__main__":
    main()
