"""Runs in Blender: blender -b --factory-startup --python-exit-code 1 --python in_compositor.py -- PICTURE FOLDER

Blender's compositor reads the layers of an .exr that limn wrote, and picks an object by its Cryptomatte. What comes out of the nodes is
compared pixel by pixel with the channels of the file as oiiotool extracts them.
"""
import pathlib
import subprocess
import sys

import bpy
import numpy

picture, folder = map(pathlib.Path, sys.argv[sys.argv.index("--") + 1:])
# Socket of the image node -> channels of the file.
SOCKETS = {"Combined": "R,G,B,A", "Depth": "Z,Z,Z", "N": "N.X,N.Y,N.Z", "P": "P.X,P.Y,P.Z", "albedo": "albedo.R,albedo.G,albedo.B", "NdotV": "NdotV.Y,NdotV.Y,NdotV.Y",
           "border": "border.Y,border.Y,border.Y", "id": "id.Y,id.Y,id.Y", "material": "material.Y,material.Y,material.Y"}


def pixels(file):
    image = bpy.data.images.load(str(file))
    image.colorspace_settings.name = "Raw"
    values = numpy.empty(len(image.pixels), numpy.float32)
    image.pixels.foreach_get(values)
    return values.reshape(image.size[1], image.size[0], 4)


def from_file(name, channels):
    """Channels of limn's file under the names of a plain picture."""
    file = folder / f"{name}_expected.exr"
    subprocess.run(["oiiotool", picture, "--ch", channels, "--chnames", "R,G,B,A"[: 2 * channels.count(",") + 1], "-d", "float", "-o", file], check=True)
    return pixels(file)


def output(tree, name):
    node = tree.nodes.new("CompositorNodeOutputFile")
    node.base_path = str(folder)
    node.format.file_format, node.format.color_depth, node.format.color_mode = "OPEN_EXR", "32", "RGBA"
    node.file_slots[0].path = f"{name}_#"
    return node


def matte(tree, image, layer, name):
    node = tree.nodes.new("CompositorNodeCryptomatteV2")
    node.source, node.image = "IMAGE", image
    node.layer_name = layer
    node.matte_id = name
    return node.outputs["Matte"]


def composite(image, mattes):
    """Every socket and matte as a file of its own."""
    scene = bpy.context.scene
    scene.use_nodes = True
    tree = scene.node_tree
    tree.nodes.clear()
    node = tree.nodes.new("CompositorNodeImage")
    node.image = image
    sockets = {socket.name: socket for socket in node.outputs if socket.enabled}
    missing = set(SOCKETS) - set(sockets)
    assert not missing, f"Blender's image node shows no {missing}: {list(sockets)}"
    for name in SOCKETS:
        tree.links.new(sockets[name], output(tree, name).inputs[0])
    for name, (layer, wanted) in mattes.items():
        tree.links.new(matte(tree, image, layer, wanted), output(tree, name).inputs[0])
    tree.links.new(sockets["Combined"], tree.nodes.new("CompositorNodeComposite").inputs[0])
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 160, 120, 100
    scene.frame_set(1)
    bpy.ops.render.render()


def coverage(layer, name):
    """What the specification says: the sum of coverages of the pairs whose id has the bits of the name's hash in the manifest."""
    header = subprocess.run(["oiiotool", "--info", "-v", picture], check=True, capture_output=True, text=True).stdout
    key = next(line.split("/")[1] for line in header.splitlines() if line.strip().endswith(f'/name: "{layer}"'))
    manifest = next(line for line in header.splitlines() if f"cryptomatte/{key}/manifest" in line)
    bits = int(manifest.split(f'"{name}":"')[1][:8], 16)
    total = 0.0
    for level in sorted({line.split(".")[0] for line in header.replace(",", " ").split() if line.startswith(layer) and ".R" in line}):
        pairs = from_file("level", ",".join(f"{level}.{c}" for c in "RGBA"))
        for rank in (0, 2):
            total = total + numpy.where(pairs[:, :, rank].view(numpy.uint32) == bits, pairs[:, :, rank + 1], 0.0)
    return total


def main():
    image = bpy.data.images.load(str(picture))
    mattes = {"matte_object": ("CryptoObject", "egg"), "matte_material": ("CryptoMaterial", "material 1")}
    composite(image, mattes)
    for name, channels in SOCKETS.items():
        count = channels.count(",") + 1
        got, expected = pixels(folder / f"{name}_1.exr")[:, :, :count], from_file(name, channels)[:, :, :count]
        assert got.shape == expected.shape, (name, got.shape, expected.shape)
        different = numpy.count_nonzero(~((got == expected) | (numpy.isnan(got) & numpy.isnan(expected))))
        print(f"compositor: {name}: {different} of {got.size} numbers differ, from {numpy.min(expected):.4g} to {numpy.max(expected):.4g}")
        assert different == 0 and numpy.ptp(expected[numpy.isfinite(expected)]) > 0.0
    for name, (layer, wanted) in mattes.items():
        got, expected = pixels(folder / f"{name}_1.exr")[:, :, 0], coverage(layer, wanted)
        worst = numpy.max(numpy.abs(got - expected))
        print(f"compositor: {layer} {wanted}: worst {worst:.2g}, {numpy.sum(expected):.1f} pixels covered")
        assert worst < 1e-6 and numpy.sum(expected) > 100.0 and numpy.any((expected > 0.0) & (expected < 1.0))
    print("in the compositor: all held")


main()
