"""The command line and Python give the same numbers to the last bit: pictures, lines, comparisons, studies, plans, judgements."""

import csv
import json
import math
import unittest

import limn
import numpy
from limn_test import TestCase

SIZE = ("--size", "200x150")
MADE = dict(size=(200, 150))
TIMES = ("_ms",)

# What is drawn: the command line's words, and Python's.
CALLS = {
    "formula": (["machined_part"], dict(scene="machined_part")),
    "level set": (
        ["gyroid", "--surface", "level_set", "--voxels", "48", "--gradient", "cubic"],
        dict(scene="gyroid", surface="level_set", voxels=48, gradient="cubic"),
    ),
    "local level set": (
        ["machined_part", "--surface", "level_set", "--voxels", "256", "--local", "0.5"],
        dict(scene="machined_part", surface="level_set", voxels=256, local=0.5),
    ),
    "local mesh": (["teacup", "--local", "0.5"], dict(scene="teacup", local=0.5)),
    "cage": (["teacup", "--level", "2"], dict(scene="teacup", level=2)),
    "several methods": (
        ["rook", "--method", "rim", "--method", "edge_quads", "--set", "rim.threshold=0.3", "--surface", "mesh", "--level", "2"],
        dict(scene="rook", methods=["rim", "edge_quads"], parameters={"rim.threshold": 0.3}, surface="mesh", level=2),
    ),
    "samples": (
        ["tilted_torus", "--samples", "5", "--background", "0.25,0.5,1", "--set", "threshold=0.35"],
        dict(scene="tilted_torus", samples=5, background=(0.25, 0.5, 1.0), parameters={"threshold": 0.35}),
    ),
    "camera": (
        ["ellipsoid", "--eye", "1.1,2.3,-4.7", "--target", "0.1,0,0.3", "--up", "0.3,1,0", "--fov", "21.5"],
        dict(scene="ellipsoid", camera=limn.Camera(eye=(1.1, 2.3, -4.7), target=(0.1, 0, 0.3), up=(0.3, 1, 0), fov=21.5)),
    ),
    "parallel rays": (["bracket", "--ortho", "2.75"], dict(scene="bracket", camera=limn.Camera(ortho=2.75))),
    "look": (
        ["teacup", "--look", "toon", "--azimuth", "70", "--elevation", "35", "--roll", "5", "--zoom", "1.2", "--margin", "0.1"],
        dict(scene="teacup", look="toon", camera=limn.Camera(azimuth=70, elevation=35, roll=5, zoom=1.2, margin=0.1)),
    ),
    "ink": (["rook", "--ink-only", "--samples", "1"], dict(scene="rook", ink_only=True, samples=1)),
    "transparent": (["gyroid", "--transparent", "--shading", "normal"], dict(scene="gyroid", transparent=True, shading="normal")),
}
CHANNELS = {
    "Z": lambda p: p.depth,
    "P.X": lambda p: p.position[:, :, 0],
    "P.Y": lambda p: p.position[:, :, 1],
    "P.Z": lambda p: p.position[:, :, 2],
    "N.X": lambda p: p.normal[:, :, 0],
    "N.Y": lambda p: p.normal[:, :, 1],
    "N.Z": lambda p: p.normal[:, :, 2],
    "NdotV.Y": lambda p: p.n_dot_v,
}
ROUNDED = {  # to half floats
    "R": lambda p: p.composite[:, :, 0],
    "G": lambda p: p.composite[:, :, 1],
    "B": lambda p: p.composite[:, :, 2],
    "A": lambda p: p.composite[:, :, 3],
    "border.Y": lambda p: p.border,
    "id.Y": lambda p: p.id,
    "material.Y": lambda p: p.material,
    "status.Y": lambda p: p.status,
}


def without_times(row):
    """What is measured again each time is no number of the picture."""
    return {name: value for name, value in row.items() if not name.endswith(TIMES) and name != "key"}


class Pictures(TestCase):
    def test_layers_are_those_of_the_file(self):
        for name, (words, settings) in CALLS.items():
            with self.subTest(name):
                file = self.file("picture.exr")
                self.program("render", *words, *SIZE, "-o", file)
                picture = limn.render(**settings, **MADE)
                for channel, layer in CHANNELS.items():
                    self.assertSameBits(limn.read_channel(file, channel), layer(picture))
                for channel, layer in ROUNDED.items():
                    self.assertSameBits(limn.read_channel(file, channel), layer(picture).astype("f2").astype("f4"))

    def test_files_are_equal_byte_for_byte(self):
        for name, (words, settings) in CALLS.items():
            with self.subTest(name):
                picture = limn.render(**settings, **MADE, mattes=True)
                self.program("render", *words, *SIZE, "-o", self.file("a.exr"), "-o", self.file("a.png"))
                for ending in ("exr", "png"):
                    picture.write(self.file("b." + ending))
                    with open(self.file("a." + ending), "rb") as a, open(self.file("b." + ending), "rb") as b:
                        self.assertEqual(a.read(), b.read())

    def test_a_scene_that_was_read_draws_as_its_file(self):
        limn.tessellate(limn.shape("torus"), 2).write(self.file("torus.obj"))
        for settings in (dict(), dict(level=2), dict(scheme="catmark"), dict(surface="mesh_level_set", voxels=32)):
            a = limn.render(self.file("torus.obj"), **settings, **MADE)
            b = limn.render(limn.load(self.file("torus.obj")), **settings, **MADE)
            c = limn.render(limn.scene(limn.Object(limn.read_mesh(self.file("torus.obj")), name="torus"), name="torus"), **settings, **MADE)
            for layer in ("depth", "normal", "composite", "material", "face"):
                self.assertSameBits(getattr(a, layer), getattr(b, layer))
                self.assertSameBits(getattr(a, layer), getattr(c, layer))

    def test_a_model_draws_what_its_scene_does(self):
        model = limn.model("gyroid", surface="level_set", voxels=32)
        a = limn.render(model, methods="sobel", **MADE)
        b = limn.render("gyroid", surface="level_set", voxels=32, methods="sobel", **MADE)
        self.assertSameBits(a.composite, b.composite)
        self.assertEqual(a.call, b.call)
        with self.assertRaisesRegex(limn.InputError, "built already"):
            limn.render(model, voxels=64)

    def test_the_call_that_a_picture_names_draws_it_again(self):
        picture = limn.render("rook", samples=2, **MADE)
        self.program(*picture.call.split()[1:], "-o", self.file("again.png"))
        with open(self.file("again.png"), "rb") as again:
            self.assertEqual(again.read(), picture._repr_png_())

    def test_a_pictures_camera_can_be_given_back(self):
        first = limn.render("teacup", camera=limn.Camera(eye=(4, 3, 5), fov=30), **MADE)
        again = limn.render("teacup", camera=first.camera)
        self.assertEqual(again.camera.size, first.camera.size)
        numpy.testing.assert_allclose(again.camera.axes, first.camera.axes, atol=1e-12)
        self.assertLess(numpy.count_nonzero(again.id != first.id), 3)
        self.assertEqual(limn.render("teacup", camera=again.camera, size=(100, 75)).depth.shape, (75, 100))

    def test_views_are_those_of_the_command_line(self):
        self.program("render", "teacup", "--views", "3", *SIZE, "-o", self.file("view.exr"))
        for view in range(3):
            picture = limn.render("teacup", view=view, views=3, **MADE)
            self.assertSameBits(limn.read_channel(self.file(f"view_v{view}.exr"), "Z"), picture.depth)


class Lines(TestCase):
    def test_the_graph_and_the_drawings_are_equal(self):
        for scene, words, settings in (
            ("machined_part", [], {}),
            ("teacup", ["--lines", "all"], dict(lines="all")),
            ("gyroid", ["--surface", "level_set", "--voxels", "32"], dict(surface="level_set", voxels=32)),
        ):
            with self.subTest(scene):
                lines = limn.contours(scene, **settings, **MADE)
                self.program("contours", scene, *words, *SIZE, "-o", self.file("lines.json"), "-o", self.file("lines.svg"))
                with open(self.file("lines.json"), encoding="utf-8") as file:
                    written = json.load(file)
                self.assertEqual(written, lines.graph())
                with open(self.file("lines.svg"), encoding="utf-8") as file:
                    self.assertEqual(file.read(), lines.svg())
                self.assertEqual(len(written["chains"]), len(lines.chains))
                self.compare_points(written, lines)

    def compare_points(self, written, lines):
        for chain, ours in zip(written["chains"], lines.chains):
            self.assertEqual((chain["class"], chain["closed"]), (ours.line_class, ours.closed))
            length = len(ours.px)
            for array in (ours.depth, ours.position, ours.normal, ours.radial_curvature):
                self.assertEqual(len(array), length)
            projected = lines.camera.project(ours.position)
            # Points are placed in the picture to the solver's tolerance of their places in the world.
            self.assertLess(float(numpy.abs(projected[:, :2] - ours.px).max()), 0.05)

    def test_drawings_take_the_same_settings(self):
        self.program("contours", "machined_part", "--hidden", "--style", "technical", "--curves", "arc", *SIZE, "-o", self.file("a.svg"),
                     "-o", self.file("a.dxf"))
        lines = limn.contours("machined_part", **MADE)
        for ending in ("svg", "dxf"):
            lines.write(self.file("b." + ending), hidden=True, style="technical", curves="arc")
            with open(self.file("a." + ending), encoding="utf-8") as a, open(self.file("b." + ending), encoding="utf-8") as b:
                self.assertEqual(a.read(), b.read())


class Numbers(TestCase):
    def test_comparisons_and_measures_have_the_same_rows(self):
        folder = self.file("compared")
        self.program("compare", "ellipsoid", "--voxels", "24", "--level", "1", *SIZE, "-o", folder)
        with open(folder + "/rows.json", encoding="utf-8") as file:
            expected = json.load(file)
        ours = limn.compare("ellipsoid", voxels=24, level=1, **MADE).rows
        self.assertEqual([without_times(row) for row in expected], [without_times(row) for row in ours])
        measures = limn.measure("ellipsoid", surface="level_set", voxels=24, **MADE)
        compared = 0
        for row in expected:
            if row["surface"] == "level_set" and row["cell"] == "level_set" and row["metric"] in measures:
                self.assertEqual(row["value"], measures[row["metric"]], row["metric"])
                self.assertEqual(row["unit"], measures.units[row["metric"]])
                compared += 1
        self.assertGreater(compared, 20)

    def test_comparisons_of_several_methods_write_the_same_files(self):
        words = ["compare", "tilted_torus", "--methods", "rim,sobel", "--surface", "level_set", "--voxels", "24", *SIZE]
        self.program(*words, "-o", self.file("a"))
        comparison = limn.compare("tilted_torus", methods=["rim", "sobel"], surfaces="level_set", voxels=24, folder=self.file("b"), **MADE)
        with open(self.file("a/level_set.exr"), "rb") as a, open(self.file("b/level_set.exr"), "rb") as b:
            self.assertEqual(a.read(), b.read())
        ink = limn.read_channel(self.file("a/level_set.exr"), "rim.Y")
        self.assertSameBits(ink, comparison.border("level_set", "rim").astype("f2").astype("f4"))

    def test_studies_have_the_same_rows(self):
        words = ["study", "ellipsoid", "--levels", "0,1", "--voxels", "16", "--gradients", "central", "--normals", "vertex", "--views", "2"]
        self.program(*words, "--thresholds", "0.2,0.4", *SIZE, "-o", self.file("study"))
        study = limn.study("ellipsoid", levels=[0, 1], voxels=[16], gradients="central", normals="vertex", views=2, thresholds=[0.2, 0.4], **MADE)
        with open(self.file("study/rows.jsonl"), encoding="utf-8") as file:
            expected = [json.loads(line) for line in file]
        self.assertEqual([without_times(row) for row in expected], [without_times(row) for row in study.rows])
        self.compare_columns(study.table)

    def compare_columns(self, table):
        with open(self.file("study/rows.csv"), encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), len(table["metric"]))
        for name in ("metric", "value", "floor", "truth_bound_px", "resolution", "bytes", "level", "voxels", "gradient", "rim.threshold"):
            for row, value in zip(rows, table[name]):
                missing = value is None or isinstance(value, float) and math.isnan(value)
                self.assertEqual(row[name] == "", missing, name)
                if not missing:
                    self.assertEqual(row[name] if isinstance(value, str) else float(row[name]), value, name)

    def test_a_study_of_a_made_level_set_is_that_of_its_file(self):
        level_set = limn.level_set(limn.shape("torus"), voxels=24)
        level_set.write(self.file("torus.vdb"))
        settings = dict(voxels=[12, 16], gradients="central", views=1, **MADE)
        made, again = limn.study(level_set, **settings), limn.study(limn.scene(limn.Object(level_set, name="torus"), name="torus"), **settings)
        read = limn.study(self.file("torus.vdb"), **settings)
        numbers = lambda study: [{k: v for k, v in without_times(row).items() if k not in ("scene", "object")} for row in study.rows]
        self.assertEqual(numbers(made), numbers(again))
        self.assertEqual(numbers(made), numbers(read))
        self.assertGreater(len(made.rows), 1)
        # Keys follow from the voxels.
        other = limn.study(limn.level_set(limn.shape("torus", minor=0.2), voxels=24), **settings)
        keys = [{row["key"] for row in study.rows} for study in (made, again, other)]
        self.assertEqual(keys[0], keys[1])
        self.assertTrue(keys[0].isdisjoint(keys[2]))

    def test_plans_choose_the_same(self):
        # Of this tolerance one level set is cheaper than all others by a sixth and more, in a process that starts and in one that has run.
        words = ["plan", "ellipsoid", "--tolerance", "0.1", "--surface", "level_set", *SIZE, "--json"]
        # What is cheapest is a matter of times, which a busy machine may measure otherwise the next moment.
        for _ in range(8):
            expected = json.loads(self.program(*words))
            plan = limn.plan("ellipsoid", tolerance=0.1, surfaces="level_set", **MADE)
            if expected["chosen"]["parameters"] == plan.chosen["parameters"]:
                break
        for name in ("tolerance_px", "metric", "threshold", "truth", "measured_px", "predicted_px", "bytes", "floor_px", "doubt"):
            self.assertEqual(expected[name], plan[name], name)
        self.assertEqual(expected["chosen"]["parameters"], plan.chosen["parameters"])
        self.assertLessEqual(limn.measure("ellipsoid", **plan.settings, **MADE)["border_error_p95"], 0.1)

    def test_a_plan_of_local_models_draws_and_measures_what_it_chose(self):
        small = dict(size=(300, 300))
        plan = limn.plan("machined_part", tolerance=0.5, surfaces="level_set", budget="6M", local=True, **small)
        self.assertIn("local", plan.settings)
        self.assertEqual(limn.model("machined_part", **plan.settings, **small).info["bytes"], plan.chosen["bytes"])
        measured = limn.measure("machined_part", **plan.settings, **small)["border_error_p95"]
        self.assertAlmostEqual(measured, plan.chosen["measured_px"], delta=1e-9)

    def test_judgements_are_the_same(self):
        self.program("contours", "machined_part", *SIZE, "-o", self.file("drawing.svg"))
        self.program("render", "machined_part", "--method", "contours", "--background", "white", *SIZE, "-o", self.file("picture.png"))
        for name in ("drawing.svg", "picture.png"):
            words = ["judge", self.file(name), "--against", "machined_part", "--max-missed", "100%", "--json"]
            expected = json.loads(self.program(*words))
            judgement = limn.judge(self.file(name), "machined_part", max_missed="100%")
            self.assertEqual(expected, dict(judgement))
            self.assertTrue(judgement.passed)
        self.assertFalse(limn.judge(self.file("drawing.svg"), "teacup", max_missed="1%").passed)

    def test_an_array_is_judged_as_its_mask_is(self):
        self.program("render", "machined_part", "--method", "contours", *SIZE, "-o", self.file("picture.exr"))
        ink = limn.read_channel(self.file("picture.exr"), "border.Y")
        judged = limn.judge(ink, "machined_part")
        again = limn.judge(limn.render("machined_part", methods="contours", **MADE).border.astype("f2"), "machined_part")
        self.assertEqual({**judged}, {**again})
        self.assertEqual(judged["width_px"] if "width_px" in judged else 200, 200)


class Truths(TestCase):
    def test_the_true_border_of_a_sphere_is_a_circle(self):
        camera = limn.Camera(eye=(0, 0, 5), target=(0, 0, 0), ortho=3, size=(300, 300))
        border = limn.truth(limn.shape("sphere", radius=1), camera=camera, threshold=0.6)
        self.assertTrue(border.exact)
        self.assertEqual(sorted(curve.kind for curve in border.curves), ["inner", "silhouette"])
        for curve in border.curves:
            radius = numpy.linalg.norm(curve.px - 150, axis=1)
            expected = 100 * (1.0 if curve.kind == "silhouette" else math.sin(math.acos(0.6)))
            self.assertLess(float(numpy.abs(radius - expected).max()), border.bound_px)
            numpy.testing.assert_allclose(numpy.linalg.norm(curve.position, axis=1), 1, atol=1e-9)
            numpy.testing.assert_allclose(curve.radial_curvature, 1, atol=1e-6)
        ring = math.pi * 100**2 * (1 - math.sin(math.acos(0.6)) ** 2)
        self.assertAlmostEqual(float(border.coverage.sum()), ring, delta=5)

    def test_a_measured_border_lies_on_the_true_one(self):
        camera = limn.Camera(eye=(0, 0, 5), target=(0, 0, 0), ortho=3, size=(150, 150))
        border = limn.border(limn.shape("sphere", radius=1), camera=camera)
        self.assertTrue(border.measured)
        self.assertIsNone(border.coverage)
        for curve in border.curves:
            radius = numpy.linalg.norm(curve.px - 75, axis=1)
            expected = 50 * (1.0 if curve.kind == "silhouette" else math.sin(math.acos(0.4)))
            self.assertLess(float(numpy.abs(radius - expected).max()), 0.02)


if __name__ == "__main__":
    unittest.main()
