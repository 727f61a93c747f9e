"""Runs in Blender: blender -b --factory-startup --python-exit-code 1 --python in_blender.py -- LIMN FOLDER SCRIPTS

A scene with a mirrored object, a modifier, an instance and a camera that looks nowhere in particular, in perspective and orthographic: limn's
lines are where Blender's own projection puts them, come back as strokes on the surface, and Freestyle's drawing is judged.
"""
import math
import pathlib
import sys

import bpy
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector

limn, folder, scripts = sys.argv[sys.argv.index("--") + 1:]
sys.path.insert(0, scripts)
import limn_lines  # noqa: E402


def make_scene():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=1.0)
    bpy.ops.mesh.primitive_cube_add(size=1.2, location=(1.4, 0.3, -0.2), rotation=(0.2, 0.5, 0.9))
    bpy.context.object.scale.x = -0.8
    bpy.ops.mesh.primitive_cylinder_add(vertices=48, radius=0.4, depth=1.0, location=(-1.5, 0.4, 0.1), rotation=(1.0, 0.2, 0.0))
    bpy.context.object.modifiers.new("bevel", "BEVEL").width = 0.1
    bpy.ops.mesh.primitive_cube_add(size=0.4, location=(0.0, -1.6, 0.8))
    bpy.context.object.hide_render = True  # and so not a line of it
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    way = Vector((0.4, -0.8, 0.5)).normalized()
    camera.location = 6.0 * way + Vector((0.1, 0.05, 0.0))
    camera.rotation_euler = way.to_track_quat("Z", "Y").to_euler()
    camera.rotation_euler.rotate_axis("Z", 0.3)
    scene = bpy.context.scene
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 800, 500, 80
    return scene


def check_camera(scene, lines):
    """Every point of every line, projected by Blender, is where limn has it in the picture."""
    width, height, worst, count = lines["width_px"], lines["height_px"], 0.0, 0
    assert (width, height) == (640, 400), (width, height)
    for edge in lines["edges"]:
        for position, px in zip(edge["position"], edge["px"]):
            view = world_to_camera_view(scene, scene.camera, Vector(position))
            worst = max(worst, math.hypot(view.x * width - px[0], (1.0 - view.y) * height - px[1]))
            count += 1
    assert count > 200, count
    # Blender's matrices are single precision.
    assert worst < 0.01, f"Blender projects a point {worst} px from where limn has it"
    return count, worst


def check_strokes(thing, lines):
    strokes = [stroke for layer in thing.data.layers for stroke in layer.frames[0].strokes]
    visible = [chain for chain in lines["chains"] if chain["invisibility"] == 0]
    assert len(strokes) == len(visible) > 3, (len(strokes), len(visible))
    corners = {tuple(round(x, 4) for x in point) for edge in lines["edges"] for point in edge["position"]}
    for stroke in strokes:
        for point in stroke.points:
            assert tuple(round(x, 4) for x in point.co) in corners or min(math.dist(point.co, corner) for corner in corners) < 1e-3
    return len(strokes)


def check(scene, name):
    out = pathlib.Path(folder) / name
    thing, lines = limn_lines.draw(bpy.context, out, limn)
    count, worst = check_camera(scene, lines)
    strokes = check_strokes(thing, lines)
    bpy.data.objects.remove(thing)
    report = limn_lines.judge_freestyle(bpy.context, out, limn)["all"]
    missed, wrong, p95 = report["missed_px"] / report["visible_px"], report["false_px"], report["displacement_px"]["p95"]
    print(f"{name}: {count} points within {worst:.5f} px of Blender's projection, {strokes} strokes; Freestyle misses {100 * missed:.2f} %, "
          f"{wrong:.1f} px false, 95 % within {p95:.3f} px")
    # The same meshes, the same creases: what is left is Freestyle's own error.
    assert missed < 0.05 and p95 < 0.5, report


def main():
    scene = make_scene()
    check(scene, "perspective")
    scene.camera.data.sensor_fit = "VERTICAL"
    check(scene, "vertical_sensor")
    scene.camera.data.type = "ORTHO"
    scene.camera.data.ortho_scale = 5.0
    check(scene, "orthographic")
    scene.camera.data.shift_x = 0.1
    try:
        limn_lines.export(bpy.context, folder)
    except limn_lines.LimnError as refusal:
        assert "shifted" in str(refusal)
    else:
        raise AssertionError("a shifted lens is not refused")
    print("in Blender: all held")


main()
