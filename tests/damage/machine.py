"""Disks that are full, folders that may not be written to or that vanish, streams that are closed: what limn does then (kills.py)."""
import contextlib
import os
import pathlib
import shutil
import subprocess
import time

import child

SCENE = "[[object]]\nshape = \"ellipsoid\"\nradii = [1.0, 0.7, 0.5]\n"


def calls(limn, scene, out, brief=False):
    """One call of each kind of output, which it writes in `out`; in brief those whose files are written by different libraries."""
    small = ["--size", "96x64", "-q"]
    every = {
        "render .exr": [limn, "render", scene, "-o", out / "a.exr", *small],
        "render .png": [limn, "render", scene, "-o", out / "a.png", *small],
        "render .tif": [limn, "render", scene, "-o", out / "a.tif", *small],
        "render .jpg": [limn, "render", scene, "-o", out / "a.jpg", *small],
        "compare": [limn, "compare", scene, "-o", out / "compare", "--voxels", "24", *small],
        "study": [limn, "study", scene, "-o", out / "study", "--levels", "0,1", "--voxels", "8,16", "--views", "1", "--size", "48x36", "-q"],
        "export .ply": [limn, "export", scene, "-o", out / "a.ply", "--level", "4", "-q"],
        "export .obj": [limn, "export", scene, "-o", out / "a.obj", "--level", "4", "-q"],
        "export .vdb": [limn, "export", scene, "-o", out / "a.vdb", "--voxels", "48", "-q"],
    }
    return {name: call for name, call in every.items() if not brief or name in ("render .exr", "render .png", "export .ply", "export .vdb")}


@contextlib.contextmanager
def mounted(folder, *arguments):
    """A mount of its own, or None where this process may not make one."""
    folder.mkdir(parents=True, exist_ok=True)
    made = os.geteuid() == 0 and shutil.which("mount") and \
        subprocess.run(["mount", *arguments, str(folder)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode == 0
    try:
        yield folder if made else None
    finally:
        if made:
            subprocess.run(["umount", str(folder)], check=True)


def scene_in(folder):
    folder.mkdir(parents=True, exist_ok=True)
    scene = folder / "scene.toml"
    scene.write_text(SCENE)
    return scene


def judge(name, done, tally, allowed):
    tally.tried += 1
    tally.outcomes[f"exit {done.code}"] += 1
    if done.timed_out or done.code not in allowed:
        tally.fail(f"{name}: ended with {done.code} instead of {' or '.join(map(str, allowed))}", done.err)
    elif done.code != 0 and (len(done.err_lines) != 1 or not done.err.startswith("limn: ")):
        tally.fail(f"{name}: says {len(done.err_lines)} lines instead of one", done.err)


def hidden_in(folder):
    return [str(p.relative_to(folder)) for p in folder.rglob(".limn-*")]


def whole(folder, undisturbed):
    """Files that are in the folder but shorter than an undisturbed run's; a study's journal may end early, the next run goes on there."""
    found = []
    for name, data in child.contents(folder).items():
        reference = undisturbed.get(name)
        if data is None or pathlib.Path(name).name in ("rows.jsonl", "rows.csv"):
            continue
        # Pages hold times, whose number of digits varies.
        if reference is not None and len(data) < 0.9 * len(reference):
            found.append(name)
    return found


def disk_full(limn, folder, tally, brief):
    """Disks of several sizes, so that some files fit and others break off. What was there stays."""
    scene = scene_in(folder)
    disk = folder / "disk"
    for name in calls(limn, scene, disk, brief):
        free = folder / "undisturbed"
        shutil.rmtree(free, ignore_errors=True)
        free.mkdir()
        child.must(calls(limn, scene, free)[name])
        undisturbed = child.contents(free)
        needed = sum(len(data) for data in undisturbed.values() if data)
        for share in (0.3,) if brief else (0.0, 0.3, 0.8):
            size = max(16384, int(share * needed) // 4096 * 4096)
            with mounted(disk, "-t", "tmpfs", "-o", f"size={size}", "tmpfs") as there:
                if not there:
                    tally.skipped = "no disk of a size of its own can be mounted here (root may)"
                    return tally
                if size > needed:
                    continue
                judge(f"{name}, disk of {size} bytes for {needed}", child.run(calls(limn, scene, disk)[name]), tally, (1,))
                for fault, files in (("left", hidden_in(disk)), ("is not whole:", whole(disk, undisturbed))):
                    if files:
                        tally.fail(f"{name}, disk of {size} bytes: {fault} {files}")
    return tally


def read_only(limn, folder, tally, brief):
    scene = scene_in(folder)
    disk = folder / "disk"
    with mounted(disk, "-t", "tmpfs", "-o", "ro", "tmpfs") as there:
        if not there:
            tally.skipped = "no read-only disk can be mounted here (root may)"
            return tally
        for name, call in calls(limn, scene, disk, brief).items():
            judge(name, child.run(call), tally, (2,))
    return tally


def wait_for_file(folder):
    until = time.monotonic() + 10
    while time.monotonic() < until and not any(os.scandir(folder)):
        pass


def folder_gone(limn, folder, tally, brief):
    """The output folder is removed at several moments while the call runs: done, because it is made again, or refused with one line."""
    scene = scene_in(folder)
    for name in calls(limn, scene, folder, brief):
        # None: as soon as anything is in the folder, which is while it is written.
        for moment in (0.1, None) if brief else (0.02, 0.05, 0.1, 0.2, 0.4, None, None, None):
            out = folder / "out"
            shutil.rmtree(out, ignore_errors=True)
            out.mkdir()
            err = folder / "err.txt"
            with open(err, "w") as stream:
                process = child.start(calls(limn, scene, out)[name], stdout=subprocess.DEVNULL, stderr=stream)
                wait_for_file(out) if moment is None else time.sleep(moment)
                shutil.rmtree(out, ignore_errors=True)
                child.wait(process, 60)
            text = err.read_text()
            when = "folder gone while it was written" if moment is None else f"folder gone after {moment} s"
            judge(f"{name}, {when}", child.Done(process.returncode, 0, 0, 0, False, "", text), tally, (0, 1, 2))
            if out.exists() and hidden_in(out):
                tally.fail(f"{name}, {when}: left {hidden_in(out)}")
    return tally


def streams(limn, folder, tally, brief):
    """Standard output closed, full, or with nobody at its other end; all three streams closed. Files are whole whatever happens."""
    scene = scene_in(folder)
    picture = folder / "a.png"
    texts = [[limn, "--help"], [limn, "--version"], [limn, "list", "shapes", "--json"], [limn, "info", scene, "--json"],
             [limn, "render", scene, "-o", picture, "--size", "64x48", "--json"]]
    if brief:
        texts = texts[:1] + texts[-1:]
    child.must([limn, "render", scene, "-o", picture, "--size", "64x48", "-q"])
    reference = picture.read_bytes()
    for call in texts:
        name = " ".join(map(str, call[1:]))
        with open("/dev/full", "w") as full:
            judge(f"{name} > /dev/full", child.run(call, stdout=full), tally, (1,))
        judge(f"{name} >&-", child.run(["sh", "-c", 'exec "$@" >&-', "sh", *call]), tally, (1,))
        judge(f"{name} | nobody", child.run(["bash", "-c", 'set -o pipefail; { sleep 0.2; exec "$@"; } | exec true', "sh", *call]), tally, (1,))
        # Nothing can be said then; the picture must not hold what was meant for the streams.
        silent = child.run(["sh", "-c", 'exec "$@" <&- >&- 2>&-', "sh", *call])
        tally.tried += 1
        if silent.code != 1:
            tally.fail(f"{name} with all streams closed: ended with {silent.code} instead of 1")
        if picture.read_bytes() != reference:
            tally.fail(f"{name}: the picture is another with other streams")
    mesh = folder / "ball.stl"
    mesh.write_text("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid x\n")
    closed = child.run(["sh", "-c", 'exec "$@" <&- 2>&-', "sh", limn, "info", mesh, "--json"])
    tally.tried += 1
    if closed.code != 0 or '"mesh"' not in closed.out:
        tally.fail(f"a mesh cannot be read with standard input and errors closed: {closed.code}", closed.err)
    return tally


CHECKS = {"disk_full": disk_full, "read_only": read_only, "folder_gone": folder_gone, "streams": streams}
