# The silhouette of a sphere by Blender's Freestyle: blender --background --python freestyle_sphere.py -- FACES SIZE
# Prints the time until the strokes are there (drawing them as a picture is left out), and how far the strokes lie from the circle that the
# silhouette is, in pixels.
import math
import sys
import time

import bpy
import mathutils
from freestyle.chainingiterators import ChainSilhouetteIterator
from freestyle.predicates import NotUP1D, QuantitativeInvisibilityUP1D, TrueUP1D
from freestyle.types import Operators, StrokeShader

faces, size = (int(text) for text in sys.argv[sys.argv.index("--") + 1:])
bpy.ops.wm.read_factory_settings(use_empty=True)
segments = round(math.sqrt(2 * faces))
bpy.ops.mesh.primitive_uv_sphere_add(segments=segments, ring_count=segments // 2, radius=1.0)
bpy.ops.object.shade_smooth()
scene = bpy.context.scene
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
way = mathutils.Vector((0.45, -0.7, 0.55)).normalized()  # along none of the mesh's planes
camera.location = 4.0 * way
camera.rotation_euler = way.to_track_quat("Z", "Y").to_euler()
camera.data.type = "ORTHO"
camera.data.ortho_scale = 2.4
scene.collection.objects.link(camera)
scene.camera = camera
scene.render.resolution_x = scene.render.resolution_y = size
scene.render.engine = "CYCLES"
scene.cycles.samples = 1
scene.cycles.use_denoising = False
scene.cycles.device = "CPU"
scene.render.use_freestyle = True
layer = bpy.context.view_layer
layer.use_freestyle = True
layer.freestyle_settings.mode = "SCRIPT"
strokes_px = []
finished = []


class Collect(StrokeShader):
    def shade(self, stroke):
        strokes_px.append([(vertex.point.x, vertex.point.y) for vertex in stroke])


def strokes():
    Operators.select(QuantitativeInvisibilityUP1D(0))
    Operators.bidirectional_chain(ChainSilhouetteIterator(), NotUP1D(QuantitativeInvisibilityUP1D(0)))
    Operators.create(TrueUP1D(), [Collect()])
    finished.append(time.monotonic())


text = bpy.data.texts.new("style.py")
bpy.app.driver_namespace["limn_strokes"] = strokes
text.write("import bpy\nbpy.app.driver_namespace['limn_strokes']()\n")
layer.freestyle_settings.modules.new().script = text
scene.render.filepath = "/dev/null"
start = time.monotonic()
bpy.ops.render.render()
radius = size / 2.4
off = []
for stroke in strokes_px:
    for (ax, ay), (bx, by) in zip(stroke, stroke[1:]):
        for share in (0.0, 0.25, 0.5, 0.75, 1.0):
            x, y = ax + share * (bx - ax), ay + share * (by - ay)
            off.append(abs(math.hypot(x - size / 2.0, y - size / 2.0) - radius))
milliseconds = 1000.0 * (finished[0] - start)
print(f"freestyle {segments * (segments // 2)} {milliseconds:.1f} {max(off):.4f} {math.sqrt(sum(x * x for x in off) / len(off)):.4f}")
