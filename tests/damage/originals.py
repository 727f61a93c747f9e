"""One undamaged file of each kind, made afresh by limn itself, by vdb_tool, or here."""
import json
import shutil
import struct

import child

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
BALL = '[[object]]\nshape = "ellipsoid"\nradii = [1.0, 0.7, 0.5]\n'
CAGE = """v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8
t interpolateboundary 1/0/0 1
t crease 2/1/0 0 1 2.5
t crease 2/1/0 1 2 10
t corner 1/1/0 6 3.0
"""
PICTURES = ("exr", "png", "tif", "jpg")


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
    facets = b"".join(struct.pack("<3f", 0, 0, 0) + b"".join(struct.pack("<3f", *vertices[i]) for i in t) + b"\0\0" for t in triangles)
    return b"made for damage".ljust(80) + struct.pack("<I", len(triangles)) + facets


def ascii_ply(vertices, triangles):
    head = (f"ply\nformat ascii 1.0\nelement vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
            f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n")
    return head + "".join("{:g} {:g} {:g}\n".format(*v) for v in vertices) + "".join("3 {} {} {}\n".format(*t) for t in triangles)


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


def make_volumes(limn, folder, ball, files):
    files["vdb"] = folder / "ball.vdb"
    child.must([limn, "export", ball, "-o", files["vdb"], "--surface", "level_set", "--voxels", "16", "--quiet"])
    if not shutil.which("vdb_tool"):
        print("skipped: .vdb of OpenVDB's own making, because vdb_tool is missing; the package libopenvdb-tools brings it", flush=True)
        return
    for codec in ("none", "zip", "blosc"):
        files[f"vdb {codec}"] = folder / f"sphere-{codec}.vdb"
        child.must(["vdb_tool", "-quiet", "-sphere", "dim=16", "-write", f"codec={codec}", files[f"vdb {codec}"]])


def make(limn, folder):
    """Kind -> file; for a shard the folder that holds a study's two parts."""
    files = {"toml": folder / "egg.toml", "obj tags": folder / "cage.obj"}
    files["toml"].write_text(SCENE)
    files["obj tags"].write_text(CAGE)
    ball = folder / "ball.toml"
    ball.write_text(BALL)
    files["obj"], files["ply binary"] = folder / "ball.obj", folder / "ball.ply"
    for kind in ("obj", "ply binary"):
        child.must([limn, "export", ball, "-o", files[kind], "--level", "1", "--quiet"])
    vertices, triangles = read_obj(files["obj"])
    files["ply ascii"] = folder / "ball-ascii.ply"
    files["ply ascii"].write_text(ascii_ply(vertices, triangles))
    for ending, data in (("glb", glb(vertices, triangles)), ("stl", stl(vertices, triangles))):
        files[ending] = folder / f"ball.{ending}"
        files[ending].write_bytes(data)
    make_volumes(limn, folder, ball, files)
    for ending in PICTURES:
        files[ending] = folder / f"picture.{ending}"
        child.must([limn, "render", ball, "-o", files[ending], "--size", "24x16", "--quiet"])
    files["shard"] = folder / "study"
    for part in ("1/2", "2/2"):
        child.must([limn, "study", ball, "-o", files["shard"], "--shard", part, "--levels", "0,1", "--voxels", "8,16", "--views", "1",
                    "--size", "32x24", "--quiet"])
    return files


def files_of(original):
    """What may be damaged of it: the file, or those of a study's parts that limn merge reads."""
    if original.is_file():
        return [original]
    return sorted(p for p in original.rglob("*") if p.name in ("rows.jsonl", "study.json"))
