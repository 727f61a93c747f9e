#!/usr/bin/env python3
"""Headers of .exr files as oiiotool reads them, against the conventions of compositors and of Cryptomatte 1.2.0.

exr_layers.py LIMN FOLDER

Nuke and Natron are in no package of Debian. What they ask of a file is checked here: one part of scanlines; R, G, B, A and Z without a layer;
other channels as LAYER.CHANNEL with one dot, in layers of at most four channels, all of which have one size; Cryptomatte's four keys, under
the hash of the layer's name, with names whose hashes are those of the manifest.
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys

USUAL = {"R", "G", "B", "A", "Z", "N.X", "N.Y", "N.Z", "P.X", "P.Y", "P.Z", "albedo.R", "albedo.G", "albedo.B"}
ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
FAILURES = []


def check(fine, text):
    if not fine:
        FAILURES.append(text)
        print(f"wrong: {text}")


def murmur(text):
    """MurmurHash3_x86_32 with seed 0, moved off exponents of 0 and 255."""
    data, whole = text.encode(), 0xFFFFFFFF
    rotated = lambda x, r: (x << r | x >> (32 - r)) & whole
    mixed = lambda k: rotated(k * 0xCC9E2D51 & whole, 15) * 0x1B873593 & whole
    h, end = 0, len(data) // 4 * 4
    for i in range(0, end, 4):
        h = (rotated(h ^ mixed(int.from_bytes(data[i:i + 4], "little")), 13) * 5 + 0xE6546B64) & whole
    if data[end:]:
        h ^= mixed(int.from_bytes(data[end:], "little"))
    h ^= len(data)
    for factor in (0x85EBCA6B, 0xC2B2AE35):
        h = (h ^ h >> (16 if factor == 0x85EBCA6B else 13)) * factor & whole
    h ^= h >> 16
    return h ^ 1 << 23 if h >> 23 & 255 in (0, 255) else h


def header_of(file):
    return subprocess.run(["oiiotool", "--info", "-v", file], check=True, capture_output=True, text=True).stdout


def attributes(header):
    return dict(re.findall(r'(?m)^    (cryptomatte/\S+): "(.*)"$', header))


def check_channels(header, where):
    listed = re.search(r"channel list: (.*)", header)[1]
    names = re.findall(r"(\S+) \((?:half|float|uint)\)", listed)
    check(USUAL <= set(names), f"{where}: {sorted(USUAL - set(names))} are missing")
    check("oiio:subimages: 1" in header, f"{where}: not one part")
    check("tile" not in header.split("channel list")[0], f"{where}: tiles")
    layers = {}
    for name in names:
        check(name.count(".") <= 1 and re.fullmatch(r"[A-Za-z0-9_]+(\.[RGBAXYZ])?", name), f"{where}: a channel is called {name}")
        layers.setdefault(name.rpartition(".")[0], []).append(name)
    for layer, members in layers.items():
        check(len(members) <= 4 or layer == "", f"{where}: the layer {layer} has {len(members)} channels")
    check(set(layers[""]) == {"R", "G", "B", "A", "Z"}, f"{where}: without a layer are {layers['']}")
    return names


def check_mattes(header, names, objects, where):
    found = attributes(header)
    keys = {key.split("/")[1] for key in found}
    check(len(keys) == 2, f"{where}: {len(keys)} Cryptomattes")
    for key in keys:
        own = {name.split("/")[2]: value for name, value in found.items() if name.split("/")[1] == key}
        check(set(own) == {"name", "hash", "conversion", "manifest"}, f"{where}: {key} has {sorted(own)}")
        check(key == f"{murmur(own['name']):08x}"[:7], f"{where}: {own['name']} is filed under {key}")
        check((own["hash"], own["conversion"]) == ("MurmurHash3_32", "uint32_to_float32"), f"{where}: {own}")
        manifest = json.loads(own["manifest"])
        for name, value in manifest.items():
            check(f"{murmur(name):08x}" == value, f"{where}: {name} has the hash {value}")
        if own["name"] == "CryptoObject":
            check(set(manifest) == objects, f"{where}: the objects {sorted(manifest)}")
        # 32 bits each: half floats would lose the names.
        for channel in "RGBA":
            check(f"{own['name']}00.{channel}" in names, f"{where}: no {own['name']}00.{channel}")
            check(f"{own['name']}00.{channel} (float)" in header, f"{where}: {own['name']}00.{channel} is no float")


def main():
    if not shutil.which("oiiotool"):
        print("skipped: no oiiotool; the package openimageio-tools brings it")
        sys.exit(77)
    limn, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    scenes = {ROOT / "samples" / "scenes" / "still_life.toml": {"table", "egg", "bowl", "ring"}, "passing_tori": None, "teacup": None}
    for scene, objects in scenes.items():
        file = folder / f"{pathlib.Path(scene).stem}.exr"
        subprocess.run([limn, "render", scene, "--size", "80x60", "-q", "-o", file], check=True)
        header = header_of(file)
        names = check_channels(header, file.name)
        if objects is None:
            key = next(key for key, value in attributes(header).items() if value == "CryptoObject").replace("/name", "/manifest")
            objects = set(json.loads(attributes(header)[key]))
        check_mattes(header, names, objects, file.name)
        print(f"{file.name}: {len(names)} channels, {len(objects)} objects")
    print(f"{len(FAILURES)} failures")
    sys.exit(1 if FAILURES else 0)


if __name__ == "__main__":
    main()
