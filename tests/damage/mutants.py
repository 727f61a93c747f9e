#!/usr/bin/env python3
"""Feeds damaged files to limn: whatever they hold, it ends with 0 or 2 in time and memory, says what is wrong with which file, and leaves nothing.

mutants.py LIMN FOLDER [--count N] [--seed S] [--kind NAME] [--keep] [--json FILE]

Originals are made afresh in FOLDER by limn itself and by vdb_tool; the files of the corpus beside this script are added to them: every one
that once did harm. A mutant is the original after one to three of: bits flipped, cut short, a run doubled, a run taken out, 32 bits set to a
telling value. The seed is printed, and which mutant failed; --keep leaves the failed ones in FOLDER.
"""
import argparse
import json
import os
import pathlib
import random
import resource
import shutil
import struct
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
TIME_LIMIT_S = 60
MEMORY_LIMIT = 12 << 30  # of the address space, for the program and its readers
SCENE = """[camera]
eye = [3.0, 2.0, 4.0]
fov = 35.0
[[object]]
name = "egg"
shape = "ellipsoid"
radii = [1.0, 0.7, 0.5]
translate = [0.0, 0.2, 0.0]
rotate = [0.0, 1.0, 0.0, 30.0]
[[object]]
csg = "difference"
of = [ { shape = "box", half = [0.4, 0.4, 0.4] }, { shape = "sphere", radius = 0.5 } ]
[border]
method = "rim"
threshold = 0.4
"""


def run(command, **options):
    return subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, **options)


def must(command):
    done = run(command)
    if done.returncode != 0:
        sys.exit(f"mutants: {' '.join(map(str, command))} ended with {done.returncode}: {done.stderr.decode(errors='replace')}")


def glb(vertices, triangles):
    """A binary glTF of one mesh."""
    data = b"".join(struct.pack("<3f", *v) for v in vertices) + b"".join(struct.pack("<3H", *t) for t in triangles)
    data += b"\0" * (-len(data) % 4)
    points = 12 * len(vertices)
    lower, upper = ([f(v[k] for v in vertices) for k in range(3)] for f in (min, max))
    text = json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(vertices), "type": "VEC3", "min": lower, "max": upper},
                      {"bufferView": 1, "componentType": 5123, "count": 3 * len(triangles), "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": points},
                        {"buffer": 0, "byteOffset": points, "byteLength": 6 * len(triangles)}],
        "buffers": [{"byteLength": len(data)}]}).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def stl(vertices, triangles):
    """A binary STL."""
    facets = b"".join(struct.pack("<3f", 0, 0, 0) + b"".join(struct.pack("<3f", *vertices[i]) for i in t) + b"\0\0" for t in triangles)
    return b"made for damage".ljust(80) + struct.pack("<I", len(triangles)) + facets


def read_obj(file):
    vertices, triangles = [], []
    for line in file.read_text().splitlines():
        parts = line.split()
        if parts[:1] == ["v"]:
            vertices.append([float(x) for x in parts[1:4]])
        elif parts[:1] == ["f"]:
            corners = [int(p.split("/")[0]) - 1 for p in parts[1:]]
            triangles += [(corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)]
    return vertices, triangles


CAGE = """v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8
t interpolateboundary 1/0/0 1
t crease 2/1/0 0 1 2.5
t crease 2/1/0 1 2 10
t corner 1/1/0 6 3.0
"""


def originals(limn, folder):
    """kind -> file."""
    files = {}
    scene = folder / "egg.toml"
    scene.write_text(SCENE)
    files["toml"] = scene
    ball = folder / "ball.toml"
    ball.write_text('[[object]]\nshape = "ellipsoid"\nradii = [1.0, 0.7, 0.5]\n')
    for ending in ("obj", "ply"):
        files[ending] = folder / f"ball.{ending}"
        must([limn, "export", ball, "-o", files[ending], "--level", "1", "--quiet"])
    cage = folder / "cage.obj"
    cage.write_text(CAGE)
    files["obj with tags"] = cage
    vertices, triangles = read_obj(files["obj"])
    for ending, data in (("glb", glb(vertices, triangles)), ("stl", stl(vertices, triangles))):
        files[ending] = folder / f"ball.{ending}"
        files[ending].write_bytes(data)
    files["vdb"] = folder / "ball.vdb"
    must([limn, "export", ball, "-o", files["vdb"], "--surface", "level_set", "--voxels", "24", "--quiet"])
    if shutil.which("vdb_tool"):
        for codec in ("none", "zip", "blosc"):
            files[f"vdb {codec}"] = folder / f"sphere-{codec}.vdb"
            must(["vdb_tool", "-quiet", "-sphere", "dim=24", "-write", f"codec={codec}", files[f"vdb {codec}"]])
    picture = folder / "picture"
    must([limn, "render", ball, "-o", f"{picture}.exr", "--size", "24x16", "--quiet"])
    must([limn, "render", ball, "-o", f"{picture}.png", "--size", "24x16", "--quiet"])
    files["exr"], files["png"] = folder / "picture.exr", folder / "picture.png"
    study = folder / "study"
    must([limn, "study", ball, "-o", study, "--shard", "1/1", "--levels", "1", "--voxels", "16", "--views", "1", "--size", "32x24", "--quiet"])
    files["shard"] = study
    return files


TELLING = (0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x00010000, 0x7FC00000, 0x7F800000)


def damage(data, random_numbers):
    data = bytearray(data)
    for _ in range(random_numbers.choice((1, 1, 1, 2, 3))):
        if not data:
            break
        at = random_numbers.randrange(len(data))
        length = min(random_numbers.choice((1, 4, 16, 64, 256)), len(data) - at)
        way = random_numbers.randrange(5)
        if way == 0:
            for _ in range(random_numbers.choice((1, 2, 8))):
                data[random_numbers.randrange(len(data))] ^= 1 << random_numbers.randrange(8)
        elif way == 1:
            del data[at:]
        elif way == 2:
            data[at:at] = data[at:at + length]
        elif way == 3:
            del data[at:at + length]
        else:
            data[at:at + 4] = struct.pack(random_numbers.choice(("<I", ">I")), random_numbers.choice(TELLING))
    return bytes(data)


def limits():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_LIMIT, MEMORY_LIMIT))


def command_for(limn, kind, file, out):
    if kind == "shard":
        return [limn, "merge", file, "-o", out, "--quiet"], out
    if kind in ("exr", "png"):
        return [limn, "info", file], None
    picture = out.with_suffix(".png")
    return [limn, "render", file, "-o", picture, "--size", "32x24", "--threads", "1", "--quiet"], picture


def wrong_with(done, seconds, file, made):
    """What the program did that it may not; empty where nothing."""
    said = done.stderr.decode(errors="replace")
    if done.returncode not in (0, 2):
        return f"ended with {done.returncode}"
    if seconds > TIME_LIMIT_S:
        return f"took {seconds:.0f} s"
    if done.returncode == 0:
        return ""
    if made and made.exists():
        return "left an output behind"
    if file.name not in said and file.stem not in said:
        return "does not name the file"
    if not said.strip() or len(said.strip().splitlines()) > 3:
        return f"says {len(said.splitlines())} lines"
    return ""


def write_mutant(kind, original, data, folder, number):
    """A copy of the original with other bytes: for a shard, of its folder with one file of it changed."""
    if kind != "shard":
        file = folder / f"mutant{original.suffix}"
        file.write_bytes(data)
        return file
    copy = folder / "mutant-study"
    shutil.rmtree(copy, ignore_errors=True)
    shutil.copytree(original, copy)
    parts = sorted(p for p in copy.rglob("*") if p.is_file())
    parts[number % len(parts)].write_bytes(data)
    return copy


def source_of(kind, original, number):
    if kind != "shard":
        return original.read_bytes()
    parts = sorted(p for p in original.rglob("*") if p.is_file())
    return parts[number % len(parts)].read_bytes()


def try_one(limn, kind, file, folder):
    out = folder / "out"
    shutil.rmtree(out, ignore_errors=True)
    before = sorted(p.name for p in folder.iterdir())
    command, made = command_for(limn, kind, file, out)
    if made and made.exists():
        made.unlink()
        before.remove(made.name)
    start = time.monotonic()
    try:
        done = run(command, preexec_fn=limits, timeout=2 * TIME_LIMIT_S)
    except subprocess.TimeoutExpired:
        return -1, f"took more than {2 * TIME_LIMIT_S} s", ""
    wrong = wrong_with(done, time.monotonic() - start, file, made)
    left = [name for name in sorted(p.name for p in folder.iterdir()) if name not in before and not (made and name == made.name)]
    if not wrong and left:
        wrong = f"left {', '.join(left)}"
    return done.returncode, wrong, done.stderr.decode(errors="replace").strip()


def try_kind(limn, kind, original, folder, count, seed, keep):
    result = {"kind": kind, "mutants": count, "read": 0, "refused": 0, "wrong": 0}
    code, wrong, said = try_one(limn, kind, write_mutant(kind, original, source_of(kind, original, 0), folder, 0), folder)
    if kind not in ("exr", "png") and code != 0:
        sys.exit(f"mutants: the undamaged {kind} is refused, which would prove nothing: {said}")
    for number in range(count):
        random_numbers = random.Random(f"{seed} {kind} {number}")
        data = damage(source_of(kind, original, number), random_numbers)
        file = write_mutant(kind, original, data, folder, number)
        code, wrong, said = try_one(limn, kind, file, folder)
        result["read" if code == 0 else "refused"] += 1
        if wrong:
            result["wrong"] += 1
            print(f"{kind}, seed {seed}, mutant {number}: {wrong}\n  {said[:400]}", flush=True)
            if keep:
                kept = folder.parent / "failed" / f"{kind.replace(' ', '-')}-{seed}-{number}{original.suffix}"
                kept.parent.mkdir(exist_ok=True)
                shutil.copytree(file, kept, dirs_exist_ok=True) if file.is_dir() else shutil.copy(file, kept)
    return result


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("limn", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=None)
    parser.add_argument("--kind", action="append")
    parser.add_argument("--keep", action="store_true")
    parser.add_argument("--json", type=pathlib.Path)
    options = parser.parse_args()
    seed = options.seed if options.seed is not None else int.from_bytes(os.urandom(4), "little")
    print(f"seed {seed}", flush=True)
    shutil.rmtree(options.folder / "work", ignore_errors=True)
    made, work = options.folder / "made", options.folder / "work"
    for folder in (made, work):
        folder.mkdir(parents=True, exist_ok=True)
    limn = options.limn.resolve()
    results = []
    for kind, original in originals(limn, made).items():
        if options.kind and kind not in options.kind:
            continue
        results.append(try_kind(limn, kind, original, work, options.count, seed, options.keep))
        r = results[-1]
        print(f"{kind:14} {r['mutants']:5} mutants: {r['read']:4} read, {r['refused']:4} refused, {r['wrong']:3} wrong", flush=True)
    for file in sorted((HERE / "corpus").glob("*")) if (HERE / "corpus").is_dir() else []:
        code, wrong, said = try_one(limn, "corpus", file, work)
        results.append({"kind": f"corpus/{file.name}", "mutants": 1, "read": int(code == 0), "refused": int(code != 0), "wrong": int(bool(wrong))})
        if wrong:
            print(f"corpus/{file.name}: {wrong}\n  {said[:400]}")
    if options.json:
        options.json.write_text(json.dumps({"seed": seed, "kinds": results}, indent=1) + "\n")
    sys.exit(1 if any(r["wrong"] for r in results) else 0)


if __name__ == "__main__":
    main()
