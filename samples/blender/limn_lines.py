"""Lines of a Blender scene by limn: the visible objects and the camera go to limn, its lines come back as Grease Pencil and as SVG, and
Freestyle's drawing of the same view is judged against them. For Blender 3.4.

    blender -b scene.blend --python limn_lines.py -- --out FOLDER [--limn PROGRAM] [--lines A,B] [--hidden] [--freestyle] [--save FILE.blend]

FOLDER gets scene.toml with the meshes, lines.svg, lines.json and, with --freestyle, freestyle.svg, judge.html and judge.json. In Blender's
text editor: `import limn_lines; limn_lines.draw(bpy.context, "/tmp/lines")`.
"""
import argparse
import json
import math
import pathlib
import subprocess
import sys

import bpy
import mathutils

# What has a surface. Grease Pencil, empties, lights and cameras have none.
SURFACES = {"MESH", "CURVE", "SURFACE", "META", "FONT"}


class LimnError(Exception):
    """What limn, or a setting of the scene that it cannot follow, stops."""


def write_mesh(evaluated, matrix, file):
    """An evaluated object in world coordinates as .obj; False where it has no faces."""
    mesh = evaluated.to_mesh()
    try:
        if mesh is None or not mesh.polygons:
            return False
        flipped = matrix.determinant() < 0.0  # mirrored objects turn their faces inside out
        with open(file, "w") as out:
            for vertex in mesh.vertices:
                out.write("v {:.9g} {:.9g} {:.9g}\n".format(*(matrix @ vertex.co)))
            for polygon in mesh.polygons:
                corners = [index + 1 for index in polygon.vertices]
                out.write("f " + " ".join(map(str, reversed(corners) if flipped else corners)) + "\n")
        return True
    finally:
        evaluated.to_mesh_clear()


def camera_text(context):
    """The scene's camera as limn's table [camera]."""
    scene = context.scene
    camera = scene.camera
    if camera is None:
        raise LimnError("the scene has no camera")
    render = scene.render
    if not math.isclose(render.pixel_aspect_x, render.pixel_aspect_y):
        raise LimnError(f"the pixels are not square (aspect {render.pixel_aspect_x:g} to {render.pixel_aspect_y:g}); limn's are")
    width, height = (round(side * render.resolution_percentage / 100.0) for side in (render.resolution_x, render.resolution_y))
    evaluated = camera.evaluated_get(context.evaluated_depsgraph_get())
    if evaluated.data.type == "PANO":
        raise LimnError("the camera is panoramic; limn's are perspective or orthographic")
    if abs(evaluated.data.shift_x) > 1e-9 or abs(evaluated.data.shift_y) > 1e-9:
        raise LimnError("the camera's lens is shifted; limn's view is centred: set Shift X and Y to 0")
    projection = evaluated.calc_matrix_camera(context.evaluated_depsgraph_get(), x=width, y=height)
    pose = evaluated.matrix_world.normalized()
    eye, forward, up = pose.translation, pose.to_3x3() @ mathutils.Vector((0, 0, -1)), pose.to_3x3() @ mathutils.Vector((0, 1, 0))
    lines = ["[camera]"] + ["{} = [{:.17g}, {:.17g}, {:.17g}]".format(name, *vector) for name, vector in (("eye", eye), ("target", eye + forward), ("up", up))]
    if evaluated.data.type == "ORTHO":
        lines.append(f"ortho = {2.0 / projection[1][1]:.17g}")
    else:
        lines.append(f"fov = {math.degrees(2.0 * math.atan(1.0 / projection[1][1])):.17g}")
    return "\n".join([*lines, f"size = [{width}, {height}]"]) + "\n"


def export(context, folder):
    """Writes scene.toml and a mesh for each visible object and instance; returns the scene file and the objects' names, in limn's order."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    text, names = camera_text(context), []
    for instance in context.evaluated_depsgraph_get().object_instances:
        shown = instance.object if not instance.is_instance else instance.instance_object
        if shown.type not in SURFACES or not instance.show_self or shown.original.hide_render:
            continue
        file = folder / f"object_{len(names) + 1:04d}.obj"
        if not write_mesh(shown, instance.matrix_world.copy(), file):
            continue
        names.append(shown.original.name)
        text += f"\n[[object]]\nname = {json.dumps(f'{len(names)} {shown.original.name}', ensure_ascii=False)}\nmesh = \"{file.name}\"\n"
    if not names:
        raise LimnError("no visible object has faces")
    scene_file = folder / "scene.toml"
    scene_file.write_text(text)
    return scene_file, names


def run_limn(program, *arguments, answers=(0,)):
    done = subprocess.run([str(program), *map(str, arguments)], capture_output=True, text=True)
    if done.returncode not in answers:
        raise LimnError(done.stderr.strip() or f"limn ended with {done.returncode}")
    return done.stdout


def to_grease_pencil(context, lines, name="limn lines", width=30):
    """An object with a layer for each class of lines; a stroke for each chain, where the surface is."""
    data = bpy.data.grease_pencils.new(name)
    ink = bpy.data.materials.new(name)
    bpy.data.materials.create_gpencil_data(ink)
    data.materials.append(ink)
    thing = bpy.data.objects.new(name, data)
    context.scene.collection.objects.link(thing)
    for chain in lines["chains"]:
        label = chain["class"] if chain["invisibility"] == 0 else chain["class"] + " hidden"
        layer = data.layers.get(label) or data.layers.new(label)
        frame = layer.frames[0] if layer.frames else layer.frames.new(context.scene.frame_current)
        points = []
        for part in chain["edges"]:
            positions = lines["edges"][part["edge"]]["position"]
            positions = positions[::-1] if part["reversed"] else positions
            points += positions[1:] if points else positions  # where two edges meet, both have the point
        stroke = frame.strokes.new()
        stroke.display_mode, stroke.line_width, stroke.use_cyclic = "3DSPACE", width, chain["closed"]
        stroke.points.add(len(points))
        stroke.points.foreach_set("co", [number for point in points for number in point])
        stroke.points.foreach_set("pressure", [1.0] * len(points))
        stroke.points.foreach_set("strength", [1.0] * len(points))
    return thing


def draw(context, folder, program="limn", classes=None, hidden=False, crease_angle=None):
    """Sends the scene to limn and brings its lines back; returns the Grease Pencil object and the lines as lines.json has them."""
    folder = pathlib.Path(folder)
    scene_file, _ = export(context, folder)
    options = ["--lines", classes] if classes else []
    options += ["--hidden"] if hidden else []
    options += ["--crease-angle", crease_angle] if crease_angle else []
    run_limn(program, "contours", scene_file, *options, "-o", folder / "lines.svg", "-o", folder / "lines.json", "-q")
    lines = json.loads((folder / "lines.json").read_text())
    shown = lines if hidden else {**lines, "chains": [chain for chain in lines["chains"] if chain["invisibility"] == 0]}
    return to_grease_pencil(context, shown), lines


def freestyle_strokes(context):
    """The strokes of the view layer's line sets, in pixels from the top left. Renders the scene once, with one sample."""
    import parameter_editor  # Freestyle's, on Blender's path
    from freestyle.types import StrokeShader

    strokes = []

    class Collect(StrokeShader):
        def shade(self, stroke):
            strokes.append([(vertex.point.x, vertex.point.y) for vertex in stroke])

    scene, layer = context.scene, context.view_layer
    # Eevee needs a display, and Debian's Cycles has no denoiser; Freestyle's lines do not depend on what renders the faces.
    wanted = [(scene.render, "use_freestyle", True), (layer, "use_freestyle", True), (scene.render, "engine", "CYCLES"),
              (scene.cycles, "samples", 1), (scene.cycles, "use_denoising", False)]
    kept = [(owner, name, getattr(owner, name)) for owner, name, _ in wanted]
    for owner, name, value in wanted:
        setattr(owner, name, value)
    line_sets = layer.freestyle_settings.linesets
    for line_set in line_sets or [line_sets.new("visible lines")]:
        line_set.linestyle = line_set.linestyle or bpy.data.linestyles.new("limn")

    def callback(*_):
        return [Collect()]

    parameter_editor.callbacks_modifiers_post.append(callback)
    try:
        bpy.ops.render.render()
    finally:
        parameter_editor.callbacks_modifiers_post.remove(callback)
        for owner, name, value in kept:
            setattr(owner, name, value)
    height = round(scene.render.resolution_y * scene.render.resolution_percentage / 100.0)
    return [[(x, height - y) for x, y in stroke] for stroke in strokes]


def write_svg(strokes, width, height, file):
    with open(file, "w") as svg:
        svg.write(f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}">\n')
        for stroke in strokes:
            points = " ".join(f"{x:.4f},{y:.4f}" for x, y in stroke)
            svg.write(f'<polyline points="{points}" fill="none" stroke="black"/>\n')
        svg.write("</svg>\n")


def judge_freestyle(context, folder, program="limn"):
    """Freestyle draws the view, limn judges it; returns limn's report as `limn judge --json` prints it."""
    folder = pathlib.Path(folder)
    scene_file, _ = export(context, folder)
    render = context.scene.render
    width, height = (round(side * render.resolution_percentage / 100.0) for side in (render.resolution_x, render.resolution_y))
    write_svg(freestyle_strokes(context), width, height, folder / "freestyle.svg")
    # Freestyle's angle is the one between two faces, limn's the one between their normals.
    crease = 180.0 - math.degrees(context.view_layer.freestyle_settings.crease_angle)
    text = run_limn(program, "judge", folder / "freestyle.svg", "--against", scene_file, "--lines", "contour,boundary,crease",
                    "--crease-angle", f"{min(max(crease, 0.1), 179.0):.6g}", "-o", folder / "judge.html", "--json")
    (folder / "judge.json").write_text(text)
    return json.loads(text)


def main(arguments):
    parser = argparse.ArgumentParser(prog="limn_lines.py")
    parser.add_argument("--out", required=True, help="folder for what limn reads and writes")
    parser.add_argument("--limn", default="limn", help="the program")
    parser.add_argument("--lines", help="classes of lines (limn list lines)")
    parser.add_argument("--hidden", action="store_true", help="hidden lines, too")
    parser.add_argument("--freestyle", action="store_true", help="judge Freestyle's drawing of the view")
    parser.add_argument("--save", help="the scene with the lines as a .blend file")
    options = parser.parse_args(arguments)
    try:
        thing, lines = draw(bpy.context, options.out, options.limn, options.lines, options.hidden)
        print(f"limn: {len(lines['chains'])} chains, {sum(len(layer.frames[0].strokes) for layer in thing.data.layers)} strokes")
        if options.save:
            bpy.ops.wm.save_as_mainfile(filepath=str(pathlib.Path(options.save).resolve()))
        if options.freestyle:
            bpy.data.objects.remove(thing)
            everything = judge_freestyle(bpy.context, options.out, options.limn)["all"]
            print(f"Freestyle: {everything['missed_px']:.1f} of {everything['visible_px']:.1f} px missed, {everything['false_px']:.1f} px false, "
                  f"95 % within {everything['displacement_px']['p95']:.3f} px")
    except (LimnError, OSError) as problem:
        print(f"limn_lines.py: {problem}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    code = main(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])
    if code:
        sys.exit(code)
