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
import study_names
from study_numbers import Study, beaten_by, order_fit
from study_page import Page
from study_sentences import CHARTS, RULES, Sentences

STUDIES = (
    ("ellipsoid", "--levels", "0..3", "--voxels", "16,32,64", "--views", "3", "--methods", "rim,sobel", "--thresholds", "0.3,0.4"),
    ("rook", "--levels", "0..3", "--voxels", "16,32", "--views", "2"),
    ("plain.obj", "--voxels", "16,32", "--views", "2", "--methods", "rim,edge_quads"),
    # Nothing here is right to half a pixel.
    ("tilted_torus", "--surfaces", "mesh", "--levels", "0..2", "--normals", "flat", "--views", "1"),
)
# A mesh that is no cage, with smooth normals: truth is not exact there, by pixels, and edge_quads fails on its level sets.
PLAIN = """v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\ns 1
f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n"""


class Check:
    def __init__(self, folder):
        cells = rows.read_cells(folder / "rows.csv")
        self.page = Page(folder / "report.html")
        self.study = Study(cells, self.page.titles)
        self.record = json.loads((folder / "study.json").read_text(encoding="utf-8"))
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
        inexact = 0.0 if self.record["exact"] else max(truth["bound_px"] for truth in self.record["truths"])
        bound = max((truth["bound_px"] for truth in self.record["truths"]), default=0.0)
        self.same("bound of truth in words", re.findall(r"within (\S+) px", self.record["truth"]), [f"{bound:.2g}"])
        self.equal("floor", self.page.data["floor"], max(0.005, inexact), 6)

    def cells(self):
        own = {(self.study.title[cell.key], self.study.drawings[cell.key], cell.view): cell for cell in self.study.cells}
        self.same("cells", len(self.page.data["cells"]), len(own))
        for model, drawing, view, time_ms, size, values in self.page.data["cells"]:
            where = (self.page.titles[model], self.page.drawings[drawing], view)
            cell = own.get(where)
            if cell is None:
                self.wrong.append(f"{where}: no such cell in the rows")
                continue
            self.equal(f"{where} time", time_ms, cell.time_ms, 6)
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
                shown = None if one[at] is None else sorted(self.page.series[i] for i in self.page.data["beating"][one[at]])
                own = sorted({other.series for other in better}) if point.is_choice else None
                self.same(f"{place} what beats {point.title} in {kind}", shown, own)
        for one, point in zip(look["points"], points):
            # Of a single cell the page takes the numbers from the cell.
            if len(one) > 3 or len(point.errors) > 1:
                own = [*point.quantiles, point.time_ms, point.bytes]
                self.same(f"{place} {point.title} numbers", len(one), 3 + len(own))
                for shown, number, digits in zip(one[3:], own, (4, 4, 6, 4, 4, 6, 12)):
                    self.equal(f"{place} {point.title}", shown, number, digits)
        floor = self.page.data["floor"] if metric["unit"] == "px" else 0.0
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
                    orders = study_names.expected_orders(settings, metric, float(found[1]) if found else np.nan)
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
        for model, drawing, caption in self.page.captions:
            points = self.study.points(self.page.drawings[drawing], self.page.data["mainMetric"])
            point = next(one for one in points if one.title == self.page.titles[model])
            middle = (len(point.errors) - 1) // 2
            shown = re.search(r"(\S+)(?: \w+)? off, view (\d+)", caption)
            self.equal(f"caption of {point.title}", shown[1], point.errors[middle], 3)
            self.same(f"caption of {point.title}, view", int(shown[2]), point.views[middle])

    def sentences(self):
        sentences = Sentences(self.study, self.page, self.record)
        for text in self.page.sentences:
            rules = [tokens for words, tokens in RULES if re.search(words, text)]
            if len(rules) == 1:
                own = rules[0](sentences)
                self.same(f"\"{text}\"", sentences.tokens(text), sentences.tokens(text) if own is None else own)
            elif rules or sentences.tokens(text):
                self.wrong.append(f"\"{text}\": {len(rules)} rules know this sentence (tests/outside/study_sentences.py)")
        self.same("charts", sorted(self.page.charts), sorted(CHARTS))
        for stem, text in self.page.charts.items():
            self.same(f"{stem} \"{text}\"", sentences.tokens(text), CHARTS[stem](sentences))

    def run(self):
        for part in (self.models, self.cells, self.looks, self.expectations, self.table, self.captions, self.sentences):
            part()
        return not self.wrong


def make_studies(limn, folder):
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "plain.obj").write_text(PLAIN)
    for name, *options in STUDIES:
        command = [limn, "study", name, *options, "--size", "160x120", "-o", folder / name.split(".")[0], "-q"]
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=300, cwd=folder)
        if done.returncode != 0:
            sys.exit(f"{' '.join(map(str, command))} ended with {done.returncode}: {done.stderr}")
        yield folder / name.split(".")[0]


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
