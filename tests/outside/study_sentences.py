"""The numbers and names in a study page's sentences. A sentence is known by a few of its words; what is compared is the order of its numbers,
with their units, and of the models it names. So wording may change, and nothing with a number in it goes unchecked."""
import re

import numpy as np

import rows
import study_names
from study_numbers import cheapest_within, front, order_fit, views_shown

NUMBER = r"\d+(?:,\d{3})+(?! ?voxels)|\d+(?:\.\d+)?(?:e[-+]?\d+)?(?: (?:px|ms|s|kB|MB|GB|B|%)(?!\w))?"


def short(value):
    return f"{value:,.0f}" if value >= 100.0 else f"{value:.2g}"


def time_text(ms):
    return f"{ms:.1f} ms" if ms < 10.0 else f"{ms:.0f} ms" if ms < 1000.0 else f"{ms / 1e3:.2f} s"


def bytes_text(count):
    for limit, scale, text in ((1e3, 1.0, "{:.0f} B"), (1e6, 1e3, "{:.1f} kB"), (1e9, 1e6, "{:.1f} MB"), (np.inf, 1e9, "{:.2f} GB")):
        if count < limit:
            return text.format(count / scale)
    raise ValueError(count)


class Sentences:
    def __init__(self, study, page, record):
        """`record`: study.json."""
        self.study, self.page, self.record = study, page, record
        self.tolerance, self.floor = page.data["tolerance"], page.data["floor"]
        self.main, self.drawing = page.data["mainMetric"], page.drawings[page.data["mainDrawing"]]
        self.points = study.points(self.drawing, self.main)
        self.choices = [point for point in self.points if point.is_choice]
        self.failed = [cell.failed for cell in study.all_cells if cell.failed]
        names = set(page.titles) | set(page.series) | set(page.drawings) | {study_names.resolution_text(s) for s in study.settings.values()}
        quoted = {record["truth"], *self.failed, *record.get("warnings", [])}
        longest_first = sorted((text for text in names | quoted if text), key=len, reverse=True)
        self.token = re.compile("|".join([re.escape(text) for text in longest_first] + [rf"(?<![\w.])(?:{NUMBER})"]))

    def tokens(self, sentence):
        """Names of models and drawings, quotations of study.json, and numbers, in order."""
        return self.token.findall(sentence)

    def px(self, value):
        return f"{short(value)} px"

    def about(self, point):
        return [point.title, self.px(point.median)]

    def costs(self, point):
        return [time_text(point.time_ms), bytes_text(point.bytes)]

    def cells(self):
        study = self.study
        counts = [len(study.settings), len({cell.view for cell in study.all_cells}), len(set(study.drawings.values())), len(study.all_cells)]
        return [str(count) for count in counts + ([len(self.failed)] if 0 < len(self.failed) < len(study.all_cells) else [])]

    def incomplete(self):
        return [str(len(self.study.all_cells)), str(len(self.record["cells"]))]

    def truth(self):
        return [self.record["truth"]]

    def quickest(self):
        best = cheapest_within(self.choices, self.tolerance, "time")
        worst = [short(best.errors[-1])] if len(best.errors) > 1 else []
        return [f"{self.tolerance:g} px", *self.about(best), *worst, *self.costs(best)]

    def smallest(self):
        best = cheapest_within(self.choices, self.tolerance, "memory")
        return [*self.about(best), *self.costs(best)]

    def best(self):
        best, quickest = min(self.choices, key=lambda point: point.median), cheapest_within(self.choices, self.tolerance, "time")
        slower = best.time_ms > 1.05 * quickest.time_ms
        memory = [short(best.bytes / quickest.bytes)] if quickest.bytes and best.bytes > quickest.bytes else []
        return [*self.about(best), short(best.time_ms / quickest.time_ms) if slower else time_text(best.time_ms), *memory]

    def none_within(self):
        best = min(self.choices, key=lambda point: point.median)
        return [f"{self.tolerance:g} px", *self.about(best), *self.costs(best)]

    def cannot_tell(self):
        return [f"{self.tolerance:g} px", f"{self.floor:.2g} px"]

    def of_series(self, points):
        """Series in the page's order, each with its points."""
        groups = [(series, [point for point in points if point.series == series]) for series in self.page.series]
        return [(series, group) for series, group in groups if group]

    def never(self):
        tokens = [f"{self.tolerance:g} px"]
        for series, group in self.of_series(self.choices):
            best = min(group, key=lambda point: point.median)
            if best.median > self.tolerance:
                tokens += [series, self.px(best.median), study_names.resolution_text(best.settings)]
        return [token for token in tokens if token]

    def expected(self, group):
        threshold = self.page.data["drawings"][self.page.data["mainDrawing"]]["parameters"]
        found = re.search(r"threshold ([\d.e+-]+)", threshold)
        orders = study_names.expected_orders(group[0].settings, self.main, float(found[1]) if found else np.nan)
        return [] if orders is None else [f"{order:g}" for order in dict.fromkeys(orders)]

    def fits(self, points):
        floor = self.floor if self.study.unit(self.main) == "px" else 0.0
        return [(series, order_fit(group, floor), self.expected(group)) for series, group in self.of_series(points)]

    def orders(self, converging):
        least, tokens = self.page.data["leastOrder"], []
        for series, fit, expected in self.fits(self.choices):
            if fit and (fit[0] >= least) == converging:
                tokens += [series, f"{fit[0]:.2f}", *expected]
        return tokens

    def needed(self, metric, series):
        """The coarsest resolution from which on the medians stay within the tolerance."""
        resolution = ""
        for point in self.study.points(self.drawing, metric):
            if point.series == series:
                good = point.median <= self.tolerance
                resolution = (resolution or study_names.resolution_text(point.settings)) if good else ""
        return resolution

    def parts(self):
        tokens = [f"{self.tolerance:g} px"]
        for series in self.page.series:
            outer, inner = (self.needed(rows.name_in(self.page.metrics, f"{kind}_rms"), series) for kind in ("silhouette", "inner"))
            if outer != inner:
                tokens += [series, outer, inner]
        return [token for token in tokens if token]

    def pairs(self, first, second):
        """Absolute values of two metrics in the cells of the main drawing that have both."""
        cells = [cell.values for cell in self.study.cells_of(self.drawing)]
        pairs = np.array([(abs(values.get(first, np.nan)), abs(values.get(second, np.nan))) for values in cells]).reshape(-1, 2)
        return pairs[np.isfinite(pairs).all(axis=1)]

    def prediction(self):
        pairs = self.pairs(self.page.data["roles"]["predicted"], self.page.data["roles"]["compared"])
        pairs = pairs[(pairs[:, 1] > self.floor) & (pairs[:, 1] < 2.0)]
        wrong = np.sort(np.abs(pairs[:, 0] / pairs[:, 1] - 1.0))
        return [f"{100.0 * wrong[len(wrong) // 2]:.0f} %", str(len(wrong)), "2 px"]

    def failures(self):
        common = max(sorted(set(self.failed)), key=self.failed.count)
        count = self.failed.count(common)
        return [str(len(self.failed)), *([] if count == len(self.failed) else [str(count)]), common]

    def front_words(self, kind):
        unit = self.study.unit(self.main)
        tokens = [str(len(self.points))]
        for point in front(self.points, kind):
            tokens += [point.title, f"{point.median:.3g} {unit}".strip(), self.costs(point)[kind == "memory"]]
        return tokens

    def order_words(self):
        tokens = []
        for series, fit, expected in self.fits([point for point in self.points if point.resolution > 0.0]):
            tokens += [series, *([f"{fit[0]:.2f}"] if fit else []), *expected]
        return tokens

    def normal_words(self):
        roles = self.page.data["roles"]
        count = len(self.pairs(roles["compared"], roles["normal"]))
        slopes = self.pairs(roles["predicted"], roles["normal"])
        slopes = np.sort(slopes[:, 0] / slopes[:, 1])
        return [str(count), f"{slopes[len(slopes) // 2]:.2g} px"] if count else []

    def view_words(self):
        unit, tokens = self.study.unit(self.main), []
        for point in views_shown(self.points):
            tokens += [point.title, f"{point.errors[0]:.3g}", f"{point.errors[-1]:.3g} {unit}".strip(), f"{point.median:.3g}"]
        return tokens


# Words by which a sentence is known -> its numbers and names.
RULES = (
    (r"models? seen from", Sentences.cells),
    (r"study is not complete", Sentences.incomplete),
    (r"^Truth (is|itself)", Sentences.truth),
    (r"^What follows is for", lambda s: [s.drawing]),
    (r"quickest model whose border is right", Sentences.quickest),
    (r"^The smallest is", Sentences.smallest),
    (r"^The best of all", Sentences.best),
    (r"^No model comes within", Sentences.none_within),
    (r"^No model can be called right", Sentences.cannot_tell),
    (r"^Never within", Sentences.never),
    (r"does not converge to 0", lambda s: ["0", *s.orders(False)]),
    (r"error falls with the resolution", lambda s: s.orders(True)),
    (r"ask for different resolutions", Sentences.parts),
    (r"^What theory predicts", Sentences.prediction),
    (r"cells? failed", Sentences.failures),
    (r"^Warning:", lambda s: None),
)
CHARTS = {
    "chart_accuracy_time": lambda s: s.front_words("time"),
    "chart_accuracy_memory": lambda s: s.front_words("memory"),
    "chart_order": Sentences.order_words,
    "chart_normal_border": Sentences.normal_words,
    "chart_views": Sentences.view_words,
}
