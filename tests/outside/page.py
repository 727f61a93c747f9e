#!/usr/bin/env python3
"""Works out every number of a study's page again from its rows.csv, without any code of limn's: the points of all charts for every choice of
drawing, view and error, the table, the captions of pictures, and every sentence with a number in it.

page.py LIMN FOLDER                       makes studies and checks their pages
page.py --study FOLDER_OF_A_STUDY         checks the page of a study that is there
"""
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys

try:
    import numpy as np
except ImportError:
    print("skipped: no numpy; the package python3-numpy brings it")
    sys.exit(77)

import rows
import study_meshes
import study_names
from study_floor import EXACT_PX, bound_of, truths_of
from study_numbers import Study, beaten_by, order_fit
from study_page import Page
from study_sentences import CHARTS, RULES, Sentences

# Folder, what is studied, and how.
STUDIES = (
    ("ellipsoid", "ellipsoid", "--levels", "0..3", "--voxels", "16,32,64", "--views", "3", "--methods", "rim,sobel", "--thresholds", "0.3,0.4"),
    ("rook", "rook", "--levels", "0..3", "--voxels", "16,32", "--views", "2"),
    ("plain", "plain.obj", "--voxels", "16,32", "--views", "2", "--methods", "rim,edge_quads"),
    # Truth is not exact there, by pixels.
    ("plain_smooth", "plain.obj", "--voxels", "16,32", "--views", "2", "--methods", "rim,edge_quads", "--reference", "smooth"),
    # ... by a third of a pixel: there it counts against what is right, and some models can be neither right nor wrong.
    ("ball_smooth", "ball.obj", "--voxels", "16,32,64", "--views", "2", "--reference", "smooth", "--size", "80x60"),
    # Nothing here is right to half a pixel.
    ("tilted_torus", "tilted_torus", "--surfaces", "mesh", "--levels", "0..2", "--normals", "flat", "--views", "1"),
)


class Check:
    def __init__(self, folder):
        cells = rows.read_cells(folder / "rows.csv")
        self.page = Page(folder / "report.html")
        self.record = json.loads((folder / "study.json").read_text(encoding="utf-8"))
        self.study = Study(cells, self.page.titles, self.record)
        self.numbers, self.wrong = 0, []

    def equal(self, place, shown, own, digits, slack=0.0):
        """A number as shown, rounded to so many digits, against our own; None, or an empty text, stands for no number."""
        self.numbers += 1
        if shown in (None, "") or own is None or not math.isfinite(own):
            good = shown in (None, "") and (own is None or not math.isfinite(own))
        else:
            # Half a unit of the last digit, and a little for the last bits of other arithmetic.
            size = 10.0 ** (math.floor(math.log10(abs(own))) - digits + 1) if own else 0.0
            good = abs(float(shown) - own) <= 0.5001 * size + slack
        if not good:
            self.wrong.append(f"{place}: the page has {shown}, the rows give {own}")

    def same(self, place, shown, own):
        self.numbers += 1
        if shown != own:
            self.wrong.append(f"{place}: the page has {shown}, the rows give {own}")

    def models(self):
        self.same("models", sorted(self.page.titles), sorted(self.study.settings))
        self.same("drawings", sorted(self.page.drawings), sorted(set(self.study.drawings.values())))
        for model in self.page.data["models"]:
            settings = self.study.settings[model["name"]]
            self.same(f"series of {model['name']}", self.page.series[model["series"]], study_names.series_of(settings))
            self.same(f"{model['name']} is analytic", model["analytic"], settings["surface"] == "analytic")
            self.equal(f"resolution of {model['name']}", model["resolution"], self.study.resolutions[model["name"]], 6)

    def truth(self):
        """What the rows and study.json say of truth, and how small an error each metric can tell from none."""
        known = truths_of(self.record)
        bound = max(map(bound_of, known), default=0.0)
        self.same("bound of truth in words", re.findall(r"within (\S+) px", self.record["truth"]),
                  [f"{bound:.2g}"] if known else [])
        truths = {(truth["view"], truth["threshold"]): (truth["from"], truth["exact"], bound_of(truth)) for truth in known}
        for cell in self.study.cells:
            if cell.truth:
                own = truths.get((cell.view, cell.threshold))
                self.same(f"truth of cell {cell.key}", (cell.truth, cell.truth_exact, cell.truth_bound_px), own)
        exact = bool(known) and bound <= EXACT_PX and all(truth["exact"] for truth in known)
        self.same("truth is exact", self.record["exact"], exact)
        tolerance = self.page.data["tolerance"]
        in_px = {metric: self.study.floor(metric) for metric, unit in self.study.units.items() if unit == "px"}
        self.same("metrics with floors", sorted(self.page.data["floors"]), sorted(in_px))
        self.equal("floor of fits", self.page.data["fitFloor"], max((self.study.fit_floor(metric) for metric in in_px), default=None), 6)
        for metric, floor in in_px.items():
            shown = self.page.data["floors"].get(metric, {"px": None, "words": "", "right": None})
            self.equal(f"floor of {metric}", shown["px"], floor.px, 6)
            self.same(f"floor of {metric} in words", shown["words"], floor.words(0.0))
            self.equal(f"largest right {metric}", shown["right"], floor.right(tolerance), 6)

    def metrics(self):
        own = {name: (unit, study_names.is_distance(name, unit)) for name, unit in self.study.units.items()}
        self.same("metrics", {one["name"]: (one["unit"], one["distance"]) for one in self.page.data["metrics"]}, own)
        if "border_error_p95" in own:
            self.same("main error", self.page.data["mainMetric"], "border_error_p95")

    def cells(self):
        own = {(self.study.title[cell.key], self.study.drawings[cell.key], cell.view): cell for cell in self.study.cells}
        self.same("cells", len(self.page.data["cells"]), len(own))
        for model, drawing, view, time_ms, size, values, low_ms, high_ms in self.page.data["cells"]:
            where = (self.page.titles[model], self.page.drawings[drawing], view)
            cell = own.get(where)
            if cell is None:
                self.wrong.append(f"{where}: no such cell in the rows")
                continue
            for kind, shown, own_ms, parts in zip(("", " at least", " at most"), (time_ms, low_ms, high_ms),
                                                  (cell.time_ms, cell.time_low_ms, cell.time_high_ms), cell.parts_ms):
                self.equal(f"{where} time{kind}", shown, own_ms, 6)
                self.equal(f"{where} time{kind}, of its parts", own_ms, parts, 12)
            self.same(f"{where} bytes", size, cell.bytes)
            for metric, value in zip(self.page.metrics, values):
                self.equal(f"{where} {metric}", value, cell.values.get(metric), 6)

    def looks(self):
        """What charts show for a drawing, an error, and all views together or one of them."""
        for drawing, by_metric in zip(self.page.drawings, self.page.data["looks"]):
            for metric, looks in zip(self.page.data["metrics"], by_metric):
                views = [None, *self.page.data["views"]]
                if looks is None:
                    shown = metric["lower"] and bool(self.study.points(drawing, metric["name"]))
                    self.same(f"{drawing} {metric['name']} has charts", False, shown)
                    continue
                self.same(f"{drawing} {metric['name']} charts", len(looks), len(views))
                for view, look in zip(views, looks):
                    self.look(f"{drawing} {metric['name']} view {'all' if view is None else view}", look,
                              self.study.points(drawing, metric["name"], view), metric)

    def look(self, place, look, points, metric):
        self.same(f"{place} models", [self.page.titles[one[0]] for one in look["points"]], [point.title for point in points])
        for kind, at in (("time", 1), ("memory", 2)):
            for one, point, better in zip(look["points"], points, beaten_by(points, kind)):
                shown = sorted(self.page.series[i] for i in self.page.data["beating"][one[at]])
                self.same(f"{place} what beats {point.title} in {kind}", shown, sorted({other.series for other in better}))
        for one, point in zip(look["points"], points):
            # Of a single cell the page takes the numbers from the cell.
            if len(one) > 3 or len(point.errors) > 1:
                own = [*point.quantiles, point.time_ms, point.low_ms, point.high_ms, point.bytes]
                self.same(f"{place} {point.title} numbers", len(one), 3 + len(own))
                for shown, number, digits in zip(one[3:], own, (4, 4, 6, 4, 4, 6, 6, 6, 12)):
                    self.equal(f"{place} {point.title}", shown, number, digits)
        floor = self.study.fit_floor(metric["name"])
        for series, shown in zip(self.page.series, look["fits"]):
            own = order_fit([point for point in points if point.series == series], floor)
            self.same(f"{place} order of {series} is there", shown is not None, own is not None)
            # The order of what is the same at every resolution is 0 but for the last bits.
            for number, fitted, digits, slack in zip(shown or (), own or (), (6, 4, 4, 4), (1e-12, 0.0, 0.0, 0.0)):
                self.equal(f"{place} order of {series}", number, fitted, digits, slack)

    def expectations(self):
        for metric, by_series in self.page.data["expected"].items():
            for series, by_drawing in zip(self.page.series, by_series):
                settings = next(one for one in self.study.settings.values() if study_names.series_of(one) == series)
                for drawing, shown in zip(self.page.data["drawings"], by_drawing):
                    found = re.search(r"threshold ([\d.e+-]+)", drawing["parameters"])
                    orders = study_names.expected_orders(settings, metric, self.study.unit(metric), float(found[1]) if found else np.nan)
                    own = None if orders is None else " to ".join(f"{order:g}" for order in dict.fromkeys(orders))
                    self.same(f"order expected of {series}, {metric}", shown, own)

    def table(self):
        for model, drawing, shown in self.page.rows:
            title, drawn = self.page.titles[model], self.page.drawings[drawing]
            cells = [cell for cell in self.study.cells_of(drawn) if self.study.title[cell.key] == title]
            own = [np.median([cell.time_ms for cell in cells]), max(cell.bytes for cell in cells), self.study.resolutions[title]]
            for metric in self.page.metrics:
                finite = [value for value in (cell.values.get(metric, np.nan) for cell in cells) if np.isfinite(value)]
                own.append(np.median(finite) if finite else None)
            self.same(f"table {title}, {drawn} columns", len(shown), len(own))
            for name, text, number in zip(["time", "bytes", "resolution", *self.page.metrics], shown, own):
                self.equal(f"table {title}, {drawn}: {name}", text, number, 6)

    def captions(self):
        words = Sentences(self.study, self.page, self.record)
        for model, drawing, caption in self.page.captions:
            points = self.study.points(self.page.drawings[drawing], self.page.data["mainMetric"])
            point = next(one for one in points if one.title == self.page.titles[model])
            middle = (len(point.errors) - 1) // 2
            shown = re.search(r"((?:less than )?[\d.e+-]+(?: [\w%]+)?) off, view (\d+)", caption)
            self.same(f"caption of {point.title}", shown[1], words.error(point.errors[middle]))
            self.same(f"caption of {point.title}, view", int(shown[2]), point.views[middle])

    def sentences(self):
        sentences = Sentences(self.study, self.page, self.record)
        said = dict.fromkeys(range(len(RULES)), 0)
        for text in self.page.sentences:
            rules = [place for place, (words, _) in enumerate(RULES) if re.search(words, text)]
            if len(rules) == 1:
                own = RULES[rules[0]][1](sentences)
                said[rules[0]] += 1
                self.same(f"\"{text}\"", sentences.tokens(text), sentences.tokens(text) if own is None else own)
            elif rules or sentences.tokens(text):
                self.wrong.append(f"\"{text}\": {len(rules)} rules know this sentence (tests/outside/study_sentences.py)")
        for place, (words, tokens) in enumerate(RULES):
            own = tokens(sentences)
            if own is not None:
                self.same(f"sentences with \"{words}\"", said[place], 1 if own else 0)
        self.same("charts", sorted(self.page.charts), sorted(CHARTS))
        for stem, text in self.page.charts.items():
            self.same(f"{stem} \"{text}\"", sentences.tokens(text), CHARTS[stem](sentences))

    def run(self):
        for part in (self.models, self.truth, self.metrics, self.cells, self.looks, self.expectations, self.table, self.captions, self.sentences):
            part()
        return not self.wrong


def make_studies(limn, folder):
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "plain.obj").write_text(study_meshes.OCTAHEDRON)
    (folder / "ball.obj").write_text(study_meshes.ball(4))
    for name, surface, *options in STUDIES:
        size = [] if "--size" in options else ["--size", "160x120"]
        command = [limn, "study", surface, *options, *size, "-o", folder / name, "-q"]
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=300, cwd=folder)
        if done.returncode != 0:
            sys.exit(f"{' '.join(map(str, command))} ended with {done.returncode}: {done.stderr}")
        yield folder / name


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    if sys.argv[1] == "--study":
        folders = [pathlib.Path(sys.argv[2])]
    else:
        folders = make_studies(*(pathlib.Path(part).resolve() for part in sys.argv[1:]))
    good = True
    for folder in folders:
        check = Check(folder)
        good = check.run() and good
        print(f"{folder.name}: {check.numbers} numbers, names and sentences, {len(check.page.sentences) + len(check.page.charts)} of them "
              f"sentences; {len(check.wrong)} wrong", flush=True)
        for line in check.wrong[:20]:
            print(f"  {line}")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
