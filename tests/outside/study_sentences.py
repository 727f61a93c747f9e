"""The numbers and names in a study page's sentences. A sentence is known by a few of its words; what is compared is the order of its numbers,
with their units, and of the models it names. So wording may change, and nothing with a number in it goes unchecked. A rule without numbers
and names says that its sentence must not be there."""
import math
import re

import numpy as np

import study_names
from study_floor import px_text, two_digits_up
from study_numbers import front, may_be_quickest, order_fit, smallest_of, views_shown

NUMBER = r"(?:less than )?(?:\d+(?:,\d{3})+(?! ?voxels)|\d+(?:\.\d+)?(?:e[-+]?\d+)?(?: (?:px|ms|s|kB|MB|GB|B|%)(?!\w))?)"


def short(value):
    return f"{value:,.0f}" if value >= 100.0 else f"{value:.2g}"


def capital(text):
    return text[:1].upper() + text[1:]


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
        self.tolerance = page.data["tolerance"]
        self.main, self.drawing = page.data["mainMetric"], page.drawings[page.data["mainDrawing"]]
        self.points = study.points(self.drawing, self.main)
        self.choices = [point for point in self.points if not point.is_analytic]
        self.floor = study.floor(self.main)
        # Only distances of the border can be held against the tolerance, and only where truth is surer than it.
        self.in_pixels = bool(self.choices) and study_names.is_distance(self.main, study.unit(self.main))
        self.can_tell = self.in_pixels and self.floor.px <= self.tolerance
        self.right = [point for point in self.choices if self.can_tell and self.floor.is_right(point.median, self.tolerance)]
        self.nearest = min(self.choices, key=lambda point: point.median, default=None)
        self.best_known = smallest_of(may_be_quickest(self.right))
        self.failed = [cell.failed for cell in study.all_cells if cell.failed]
        # A sentence may begin with a model.
        names = set(page.titles) | set(map(capital, page.titles)) | set(page.series) | set(page.drawings)
        names |= {study_names.resolution_text(settings) for settings in study.settings.values()}
        quoted = {record["truth"], *self.failed, *record.get("warnings", [])}
        longest_first = sorted((text for text in names | quoted if text), key=len, reverse=True)
        self.token = re.compile("|".join([re.escape(text) for text in longest_first] + [rf"(?<![\w.])(?:{NUMBER})"]))

    def tokens(self, sentence):
        """Names of models and drawings, quotations of study.json, and numbers, in order."""
        return self.token.findall(sentence)

    def about(self, point):
        return [point.title, self.floor.words(point.median)]

    def error(self, value):
        """Of the main metric."""
        unit = self.study.unit(self.main)
        return self.floor.words(value) if unit == "px" else f"{value:.3g} {unit}".strip()

    def costs(self, point):
        return [time_text(point.time_ms), bytes_text(point.bytes)]

    def cells(self):
        study = self.study
        counts = [len(study.settings), len({cell.view for cell in study.all_cells}), len(set(study.drawings.values())), len(study.all_cells)]
        return [str(count) for count in counts + ([len(self.failed)] if 0 < len(self.failed) < len(study.all_cells) else [])]

    def incomplete(self):
        here, all_cells = len(self.study.all_cells), len(self.record["cells"])
        return [str(here), str(all_cells)] if here < all_cells else []

    def truth(self):
        return [self.record["truth"]] if self.record["truth"] else []

    def what_follows(self):
        return [self.drawing] if self.choices and len(self.page.drawings) > 1 else []

    def criterion(self):
        """"95 % of it" has a number."""
        return ["95 %"] if self.main.endswith("_p95") else []

    def quickest(self):
        best = self.best_known
        if best is None:
            return []
        worst = [self.floor.words(best.errors[-1])] if len(best.errors) > 1 else []
        return [f"{self.tolerance:g} px", *self.criterion(), *self.about(best), *worst, *self.costs(best)]

    def as_quick(self):
        others = [point for point in may_be_quickest(self.right) if point is not self.best_known]
        return [] if not others else [capital(others[0].title)] if len(others) == 1 else [str(len(others))]

    def smallest(self):
        smallest = smallest_of(self.right)
        return [] if smallest is self.best_known else [*self.about(smallest), *self.costs(smallest)]

    def best(self):
        best, quickest = self.nearest, self.best_known
        if quickest is None or best is quickest or best.median < self.floor.px or not (best.time_ms > 0.0 and quickest.time_ms > 0.0):
            return []
        slower = best.time_ms > 1.05 * quickest.time_ms
        memory = [short(best.bytes / quickest.bytes)] if quickest.bytes and best.bytes > quickest.bytes else []
        return [*self.about(best), short(best.time_ms / quickest.time_ms) if slower else time_text(best.time_ms), *memory]

    def none_within(self):
        if not self.can_tell or self.right or not self.floor.is_wrong(self.nearest.median, self.tolerance):
            return []
        return [f"{self.tolerance:g} px", *self.about(self.nearest), *self.costs(self.nearest)]

    def perhaps_none_within(self):
        if not self.can_tell or self.right or self.floor.is_wrong(self.nearest.median, self.tolerance):
            return []
        bound = px_text(two_digits_up(self.floor.bound_px))
        return [f"{self.tolerance:g} px", *self.about(self.nearest), *self.costs(self.nearest), bound]

    def analytic(self):
        others = [point for point in self.points if self.can_tell and point.is_analytic]
        return [token for point in others for token in self.about(point) + self.costs(point)]

    def cannot_tell(self):
        if not self.in_pixels or self.can_tell:
            return []
        floor, bound = self.floor.px, self.floor.bound_px
        if not math.isfinite(floor):
            return [f"{self.tolerance:g} px"]
        reason = bound if bound > self.tolerance else floor
        return [f"{self.tolerance:g} px", self.floor.words(0.0), px_text(two_digits_up(reason))]

    def of_series(self, points):
        """Series in the page's order, each with its points."""
        groups = [(series, [point for point in points if point.series == series]) for series in self.page.series]
        return [(series, group) for series, group in groups if group]

    def never(self):
        tokens = []
        for series, group in self.of_series(self.choices if self.can_tell else []):
            best = min(group, key=lambda point: point.median)
            if self.floor.is_wrong(best.median, self.tolerance):
                tokens += [series, self.floor.words(best.median), study_names.resolution_text(best.settings)]
        return [f"{self.tolerance:g} px", *filter(None, tokens)] if tokens else []

    def expected(self, group):
        threshold = self.page.data["drawings"][self.page.data["mainDrawing"]]["parameters"]
        found = re.search(r"threshold ([\d.e+-]+)", threshold)
        orders = study_names.expected_orders(group[0].settings, self.main, self.study.unit(self.main), float(found[1]) if found else np.nan)
        return [] if orders is None else [f"{order:g}" for order in dict.fromkeys(orders)]

    def fits(self, points):
        floor = self.study.fit_floor(self.main)
        return [(series, order_fit(group, floor), self.expected(group)) for series, group in self.of_series(points)]

    def orders(self, converging):
        least, tokens = self.page.data["leastOrder"], []
        for series, fit, expected in self.fits(self.choices):
            if fit and (fit[0] >= least) == converging:
                tokens += [series, f"{fit[0]:.2f}", *expected]
        return tokens

    def not_converging(self):
        orders = self.orders(False)
        return ["0", *orders] if orders else []

    def needed(self, metric, series):
        """The coarsest resolution from which on the medians are right to the tolerance."""
        floor, resolution = self.study.floor(metric), ""
        for point in self.study.points(self.drawing, metric):
            if point.series == series:
                good = floor.is_right(point.median, self.tolerance)
                resolution = (resolution or study_names.resolution_text(point.settings)) if good else ""
        return resolution

    def parts(self):
        kinds = [self.study.named(f"{kind}_rms") for kind in ("silhouette", "inner")]
        can_tell = self.can_tell and all(kinds) and all(self.study.floor(kind).px <= self.tolerance for kind in kinds)
        tokens = []
        for series in self.page.series if can_tell else []:
            outer, inner = (self.needed(metric, series) for metric in kinds)
            if outer != inner:
                tokens += [series, outer, inner]
        return [f"{self.tolerance:g} px", *filter(None, tokens)] if tokens else []

    def pairs(self, first, second):
        """Absolute values of two metrics in the cells of the main drawing that have both."""
        cells = [cell.values for cell in self.study.cells_of(self.drawing)]
        pairs = np.array([(abs(values.get(first, np.nan)), abs(values.get(second, np.nan))) for values in cells]).reshape(-1, 2)
        return pairs[np.isfinite(pairs).all(axis=1)]

    def prediction(self):
        predicted, compared = (self.page.data["roles"][role] for role in ("predicted", "compared"))
        if not (self.choices and predicted and compared):
            return []
        least = self.study.floor(compared).px
        wrong, inside = [], []
        for cell in self.study.cells_of(self.drawing):
            names = (predicted, compared, "prediction_displacement_low", "prediction_displacement_high")
            expected, measured, low, high = (cell.values.get(name, math.nan) for name in names)
            if not (least < measured < 2.0 and math.isfinite(expected)):
                continue
            wrong.append(abs(expected / measured - 1.0))
            if low <= high:
                inside.append(low <= measured <= high)
        if not wrong:
            return []
        share = [f"{100.0 * sum(inside) / len(inside):.0f} %"] if inside else []
        some = [str(len(inside))] if inside and len(inside) < len(wrong) else []
        return [f"{100.0 * sorted(wrong)[len(wrong) // 2]:.0f} %", str(len(wrong)), "less than 2 px", *share, *some]

    def failures(self):
        if not self.failed:
            return []
        common = max(sorted(set(self.failed)), key=self.failed.count)
        count = self.failed.count(common)
        return [str(len(self.failed)), *([] if count == len(self.failed) else [str(count)]), common]

    def front_words(self, kind):
        tokens = [str(len(self.points))]
        for point in front(self.points, kind):
            tokens += [point.title, self.error(point.median), self.costs(point)[kind == "memory"]]
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
        slopes = slopes[(slopes > 0.0).all(axis=1)]
        slopes = np.sort(slopes[:, 0] / slopes[:, 1])
        return [str(count), *([f"{slopes[len(slopes) // 2]:.2g} px"] if len(slopes) else [])] if count else []

    def view_words(self):
        tokens = []
        for point in views_shown(self.points):
            tokens += [point.title, *map(self.error, (point.errors[0], point.errors[-1], point.median))]
        return tokens


# Words by which a sentence is known -> its numbers and names.
RULES = (
    (r"models? seen from", Sentences.cells),
    (r"study is not complete", Sentences.incomplete),
    (r"^Truth (is|itself)", Sentences.truth),
    (r"^What follows is for", Sentences.what_follows),
    (r"quickest model whose border is right", Sentences.quickest),
    (r"as quick within the spread", Sentences.as_quick),
    (r"^The smallest is", Sentences.smallest),
    (r"^The best of all", Sentences.best),
    (r"^The analytic surface, drawn without", Sentences.analytic),
    (r"^No model comes within", Sentences.none_within),
    (r"^Whether a model comes within", Sentences.perhaps_none_within),
    (r"^No model can be called right", Sentences.cannot_tell),
    (r"^Never within", Sentences.never),
    (r"does not converge to 0", Sentences.not_converging),
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
